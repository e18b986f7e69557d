//! The panels of the page, from the signals of a run.

use lashloop_bench::timing::ClockName;
use lashloop_plant::Signal;
use lashloop_plant::metrics::{DRIVE_PREFIX, FIXED_SIGNALS, SignalTable};
use serde::Serialize;

/// Columns of every run after its signals.
pub(super) const TIMING_COLUMNS: [&str; 2] = ["lateness_us", "round_trip_us"];

/// A diagram of the page over time.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub(super) struct Panel {
    title: String,
    unit: String,
    /// Whether it is open at first; a click opens and closes it.
    is_open: bool,
    /// Whether its limits fill the height, however far the other curves go.
    is_enlarged: bool,
    curves: Vec<Curve>,
}

#[derive(Debug, PartialEq, Eq, Serialize)]
struct Curve {
    label: String,
    /// Index of the column.
    column: usize,
    role: Role,
}

/// The meaning of a curve; it determines the colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Role {
    Measured,
    /// The drive's own value.
    Drive,
    /// What the measured value should be.
    Reference,
    /// A limit on both sides of zero.
    Limits,
    /// One of several, with a colour of its own.
    Signal,
}

/// Most curves of a panel, which has a colour for each.
const MOST_CURVES: usize = 8;

/// Title, and per curve its label, its column and its meaning. A panel without its first curve is omitted.
type Template = (&'static str, &'static [(&'static str, &'static str, Role)]);

const TIMING: &str = "Timing";
/// The panel whose limits fill the height.
const ENLARGED: &str = "Gap, enlarged";

const PANELS: [Template; 7] = [
    (
        "Load position",
        &[
            ("load position", "load_position_rad", Role::Measured),
            ("reference", "reference_rad", Role::Reference),
        ],
    ),
    (
        "Torque",
        &[
            ("torque", "torque_nm", Role::Measured),
            ("requested by the law", "drive.requested_torque_nm", Role::Drive),
        ],
    ),
    (
        "Twist and gap",
        &[("twist", "twist_rad", Role::Measured), ("edge of the gap", "dead_zone_rad", Role::Limits)],
    ),
    (ENLARGED, &[("twist", "twist_rad", Role::Measured), ("edge of the gap", "dead_zone_rad", Role::Limits)]),
    (
        "Dead-zone estimate",
        &[
            ("estimate", "drive.dead_zone_estimate_rad", Role::Drive),
            ("truth", "dead_zone_rad", Role::Reference),
        ],
    ),
    (
        "Disturbing torque",
        &[
            ("estimate", "drive.disturbing_torque_estimate_nm", Role::Drive),
            ("truth", "disturbing_torque_nm", Role::Reference),
        ],
    ),
    (
        TIMING,
        &[("round trip", TIMING_COLUMNS[1], Role::Measured), ("lateness", TIMING_COLUMNS[0], Role::Drive)],
    ),
];

/// The columns of a run, in the order of the values that the publisher collects.
pub(super) fn columns(signals: &SignalTable) -> Vec<Signal> {
    let of_drive = |it: &Signal| format!("{DRIVE_PREFIX}{}", it.name).into();
    let drive = signals.drive.iter().map(|it| Signal { name: of_drive(it), unit: it.unit.clone() });
    let timing = TIMING_COLUMNS.map(|name| Signal::new(name, "us"));
    FIXED_SIGNALS.iter().chain(&signals.plant).cloned().chain(drive).chain(timing).collect()
}

/// The panels that these columns allow: the load's position, then the drive's own signals, all open; of the plant's signals
/// those that no other panel has, closed, as is the timing of a run in lockstep.
pub(super) fn panels(columns: &[Signal], clock: ClockName) -> Vec<Panel> {
    let of_templates: Vec<_> = templates(columns, clock).collect();
    let is_left = |column: &usize| {
        let shown = of_templates.iter().flat_map(|panel| &panel.curves);
        shown.into_iter().all(|curve| curve.column != *column)
    };
    let left: Vec<usize> = (0..columns.len()).filter(is_left).collect();
    let (own, plant): (Vec<_>, Vec<_>) =
        left.into_iter().partition(|column| columns[*column].name.starts_with(DRIVE_PREFIX));
    let own = by_unit(columns, &own, "Drive's own signals", true);
    let plant = by_unit(columns, &plant, "Signals", false);
    let mut of_templates = of_templates.into_iter();
    let first = of_templates.next();
    first.into_iter().chain(own).chain(of_templates).chain(plant).collect()
}

/// A panel for each unit, more if the colours don't suffice.
fn by_unit(columns: &[Signal], of: &[usize], what: &str, is_open: bool) -> Vec<Panel> {
    let mut panels: Vec<Panel> = Vec::new();
    for &column in of {
        let Signal { name, unit } = &columns[column];
        let curve = Curve { label: name.to_string(), column, role: Role::Signal };
        // Each title is the name of a button.
        let earlier = panels.iter().filter(|it| it.unit == **unit).count();
        let number = if earlier > 0 { format!(", {}", earlier + 1) } else { String::new() };
        let has_room = |it: &&mut Panel| it.unit == **unit && it.curves.len() < MOST_CURVES;
        match panels.iter_mut().find(has_room) {
            Some(panel) => panel.curves.push(curve),
            None => panels.push(Panel {
                title: if unit.is_empty() {
                    format!("{what} without a unit{number}")
                } else {
                    format!("{what} in {unit}{number}")
                },
                unit: unit.to_string(),
                is_open,
                is_enlarged: false,
                curves: vec![curve],
            }),
        }
    }
    panels
}

fn templates(columns: &[Signal], clock: ClockName) -> impl Iterator<Item = Panel> {
    let find = move |name: &str| columns.iter().position(|column| column.name == name);
    let panel = move |(title, curves): Template| {
        let first = find(curves[0].1)?;
        let curve = |&(label, name, role): &(&'static str, &str, Role)| {
            find(name).map(|column| Curve { label: label.to_owned(), column, role })
        };
        let curves: Vec<_> = curves.iter().filter_map(curve).collect();
        let is_enlarged = title == ENLARGED;
        let has_limits = curves.iter().any(|it| it.role == Role::Limits);
        (has_limits || !is_enlarged).then(|| Panel {
            title: title.to_owned(),
            // In lockstep the timing changes no value of the run.
            is_open: title != TIMING || clock == ClockName::RealTime,
            is_enlarged,
            unit: columns[first].unit.to_string(),
            curves,
        })
    };
    PANELS.into_iter().filter_map(panel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panel_needs_the_signal_of_its_first_curve() {
        let plant = vec![Signal::new("dead_zone_rad", "rad"), Signal::new("twist_rad", "rad")];
        let drive = vec![Signal::new("requested_torque_nm", "N m")];
        let columns = columns(&SignalTable { plant, drive });
        let panels = panels(&columns, ClockName::RealTime);
        let titles: Vec<_> = panels.iter().map(|panel| &*panel.title).collect();
        assert_eq!(
            titles,
            ["Load position", "Torque", "Twist and gap", "Gap, enlarged", "Timing", "Signals in rad"]
        );
        let names = |panel: &Panel| -> Vec<String> {
            panel.curves.iter().map(|curve| columns[curve.column].name.to_string()).collect()
        };
        assert_eq!(names(&panels[1]), ["torque_nm", "drive.requested_torque_nm"]);
        assert_eq!(names(&panels[2]), ["twist_rad", "dead_zone_rad"]);
        assert_eq!(panels[4].unit, "us");
        assert!(panels[3].is_enlarged && names(&panels[3]) == names(&panels[2]));
    }

    #[test]
    fn own_signals_have_an_open_panel_for_each_unit_behind_the_load() {
        let signals = |names: &[(&'static str, &'static str)]| -> Vec<Signal> {
            names.iter().map(|(name, unit)| Signal::new(name, unit)).collect()
        };
        let plant = signals(&[("twist_rad", "rad"), ("contact", ""), ("stored_energy_j", "J")]);
        let drive = signals(&[
            ("mine_nm", "N m"),
            ("requested_torque_nm", "N m"),
            ("phase", ""),
            ("other_nm", "N m"),
        ]);
        let columns = columns(&SignalTable { plant, drive });
        let panels = panels(&columns, ClockName::Lockstep);
        let shown: Vec<(&str, bool, usize)> =
            panels.iter().map(|it| (&*it.title, it.is_open, it.curves.len())).collect();
        let expected = [
            ("Load position", true, 2),
            ("Drive's own signals in N m", true, 2),
            ("Drive's own signals without a unit", true, 1),
            ("Torque", true, 2),
            ("Twist and gap", true, 1),
            ("Timing", false, 2),
            ("Signals in rad", false, 1),
            ("Signals without a unit", false, 1),
            ("Signals in J", false, 1),
        ];
        assert_eq!(shown, expected);
        // A gap that no signal has can't be enlarged, so no panel of it is here.
        let all: Vec<_> = panels.iter().flat_map(|it| &it.curves).map(|it| it.column).collect();
        assert_eq!(all.len(), columns.len(), "every signal has a place");
    }
}
