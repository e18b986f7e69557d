//! The panels of the page, from the signals of a run.

use lashloop_plant::Signal;
use lashloop_plant::metrics::{DRIVE_PREFIX, FIXED_SIGNALS, SignalTable};
use serde::Serialize;

/// Columns of every run after its signals.
pub(super) const TIMING_COLUMNS: [&str; 2] = ["lateness_us", "round_trip_us"];

/// A diagram of the page over time.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub(super) struct Panel {
    title: &'static str,
    unit: String,
    curves: Vec<Curve>,
}

#[derive(Debug, PartialEq, Eq, Serialize)]
struct Curve {
    label: &'static str,
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
}

/// Title, and per curve its label, its column and its meaning. A panel without its first curve is omitted.
type Template = (&'static str, &'static [(&'static str, &'static str, Role)]);

const PANELS: [Template; 6] = [
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
        "Timing",
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

/// The panels that these columns allow.
pub(super) fn panels(columns: &[Signal]) -> Vec<Panel> {
    let find = |name: &str| columns.iter().position(|column| column.name == name);
    let panel = |(title, curves): Template| {
        let first = find(curves[0].1)?;
        let curve = |&(label, name, role): &(&'static str, &str, Role)| {
            find(name).map(|column| Curve { label, column, role })
        };
        Some(Panel {
            title,
            unit: columns[first].unit.to_string(),
            curves: curves.iter().filter_map(curve).collect(),
        })
    };
    PANELS.into_iter().filter_map(panel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panel_needs_the_signal_of_its_first_curve() {
        let plant = vec![Signal::new("dead_zone_rad", "rad"), Signal::new("twist_rad", "rad")];
        let drive = vec![Signal::new("requested_torque_nm", "N m")];
        let columns = columns(&SignalTable { plant, drive });
        let panels = panels(&columns);
        let titles: Vec<_> = panels.iter().map(|panel| panel.title).collect();
        assert_eq!(titles, ["Load position", "Torque", "Twist and gap", "Timing"]);
        let names = |panel: &Panel| -> Vec<String> {
            panel.curves.iter().map(|curve| columns[curve.column].name.to_string()).collect()
        };
        assert_eq!(names(&panels[1]), ["torque_nm", "drive.requested_torque_nm"]);
        assert_eq!(names(&panels[2]), ["twist_rad", "dead_zone_rad"]);
        assert_eq!(panels[3].unit, "us");
    }
}
