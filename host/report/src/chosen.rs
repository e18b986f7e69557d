//! Panels that the user chooses: signals by name or pattern, of records and captures, over one axis.

use lashloop_record::columns::Columns;
use lashloop_record::trace::{TELEMETRY_TIME, TIME};
use lashloop_session::names::UnknownName;

use crate::draw_error::DrawError;
use lashloop_plot::{Axis, Panel, Role, Series};

/// Curves of one panel that have a colour of their own.
const MOST: usize = Role::COLOURS;

/// The shown rows of a record or of a capture.
pub(crate) struct Source<'a> {
    pub(crate) name: &'a str,
    /// The axis first.
    pub(crate) columns: &'a Columns,
    /// Whether a signal has values at some of the rows only, and is drawn from one to the next.
    pub(crate) is_sparse: bool,
}

/// A panel for every signal that matches one of the names.
pub(crate) fn apart(sources: &[Source<'_>], names: &[String]) -> Result<Vec<Panel>, DrawError> {
    let mut panels = Vec::new();
    for name in matches(sources, names)? {
        panels.push(panel(sources, &[&name], &name, &unit(sources, &name)?));
    }
    Ok(panels)
}

/// Panels with all signals that match one of the names: one panel for each unit, more if the colours don't suffice.
pub(crate) fn together(sources: &[Source<'_>], names: &[String]) -> Result<Vec<Panel>, DrawError> {
    let panels = groups(sources, names, MOST)?.into_iter().map(|Group { title, unit, names }| {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        panel(sources, &names, &title, &unit)
    });
    Ok(panels.collect())
}

/// Signals of one unit that are shown together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Group {
    pub(crate) title: String,
    pub(crate) unit: String,
    pub(crate) names: Vec<String>,
}

/// All signals that match one of the names, in groups of one unit and of at most `most`.
pub(crate) fn groups(
    sources: &[Source<'_>],
    patterns: &[String],
    most: usize,
) -> Result<Vec<Group>, DrawError> {
    let mut groups: Vec<Group> = Vec::new();
    for name in matches(sources, patterns)? {
        let unit = unit(sources, &name)?;
        match groups.iter_mut().find(|it| it.unit == unit && it.names.len() < most) {
            Some(group) => group.names.push(name),
            None => groups.push(Group { title: String::new(), unit, names: vec![name] }),
        }
    }
    for Group { title, unit, names } in &mut groups {
        let named = match &names[..] {
            [name] => name.clone(),
            _ if patterns == ["*"] => format!("Signals in {unit}"),
            _ => format!("{} in {unit}", patterns.join(", ")),
        };
        named.trim_end_matches(" in ").clone_into(title);
    }
    Ok(groups)
}

/// The signals of all sources that match the patterns, in the order of the patterns, each once.
fn matches(sources: &[Source<'_>], patterns: &[String]) -> Result<Vec<String>, DrawError> {
    let mut known: Vec<&str> = Vec::new();
    for signal in sources.iter().flat_map(|source| source.columns.signals()) {
        if !known.contains(&&*signal.name) {
            known.push(&signal.name);
        }
    }
    let mut found: Vec<String> = Vec::new();
    for pattern in patterns {
        let is_wild = pattern.contains('*');
        // The time of a row's telemetry is an axis, no signal.
        let is_axis = |name: &str| name == TELEMETRY_TIME || sources.iter().any(|it| it.axis() == name);
        let hits: Vec<&str> = known
            .iter()
            .copied()
            .filter(|name| is_match(pattern, name) && !(is_wild && is_axis(name)))
            .collect();
        if hits.is_empty() {
            return Err(UnknownName::new("the record", "signal", pattern, known).into());
        }
        for hit in hits {
            if !found.iter().any(|other| other == hit) {
                found.push(hit.to_owned());
            }
        }
    }
    Ok(found)
}

/// Whether a name matches a pattern, in which `*` stands for any characters.
fn is_match(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((start, rest)) => name.strip_prefix(start).is_some_and(|tail| {
            let mut ends = tail.char_indices().map(|(at, _)| at).chain([tail.len()]);
            ends.any(|at| is_match(rest, &tail[at..]))
        }),
    }
}

/// The unit of a signal, which is the same in all sources that have it.
fn unit(sources: &[Source<'_>], name: &str) -> Result<String, DrawError> {
    let mut units = sources.iter().filter_map(|it| it.columns.unit(name).map(|unit| (it, unit)));
    let Some((first, unit)) = units.next() else { return Ok(String::new()) };
    match units.find(|(_, other)| *other != unit) {
        None => Ok(unit.to_owned()),
        Some((other, other_unit)) => Err(DrawError::Units {
            name: name.to_owned(),
            record: first.name.to_owned(),
            unit: unit.to_owned(),
            other_record: other.name.to_owned(),
            other: other_unit.to_owned(),
        }),
    }
}

/// Colours distinguish the signals and dashes the sources; of one signal, both distinguish the sources.
fn panel(sources: &[Source<'_>], names: &[&str], title: &str, unit: &str) -> Panel {
    let quantity = if let [name] = names { name } else { "value" };
    let axis = sources.first().map_or(Axis::new("time", "s"), Source::x_axis);
    let mut panel = Panel::new(title, axis, Axis::new(quantity, unit));
    for (colour, name) in names.iter().enumerate() {
        for (number, source) in sources.iter().enumerate() {
            let Some(values) = source.columns.get(name) else { continue };
            let role = match names {
                [_] => Role::Line { colour: number, dash: number },
                _ => Role::Line { colour, dash: number },
            };
            let label = match (names, sources) {
                ([_], _) => source.name.to_owned(),
                (_, [_]) => (*name).to_owned(),
                _ => format!("{name}, {}", source.name),
            };
            let (x, y) = source.points(values);
            panel = panel.series(Series::new(label, role, x, y));
        }
    }
    panel
}

impl Source<'_> {
    /// Name of the first column.
    pub(crate) fn axis(&self) -> &str {
        self.columns.signals().first().map_or("", |signal| &signal.name)
    }

    fn x_axis(&self) -> Axis {
        match self.axis() {
            TIME => Axis::new("time", "s"),
            name => Axis::new(name, ""),
        }
    }

    fn points(&self, values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let axis = self.columns.get(self.axis()).unwrap_or_default();
        let points = axis.iter().zip(values).filter(|(_, y)| !self.is_sparse || !y.is_nan());
        points.map(|(x, y)| (*x, *y)).unzip()
    }
}

#[cfg(test)]
mod tests {
    use lashloop_plant::Signal;

    use super::*;

    fn columns(signals: &[(&'static str, &'static str)]) -> Columns {
        let time = [("time_s", "s")];
        let signals: Vec<Signal> =
            time.iter().chain(signals).map(|(name, unit)| Signal::new(name, unit)).collect();
        let count = signals.len();
        let mut columns = Columns::new(signals);
        columns.push((0..count).map(|column| column as f64));
        columns.push((0..count).map(|column| if column == 0 { 1.0 } else { f64::NAN }));
        columns
    }

    fn sources<'a>(columns: &'a [Columns], names: &'a [&'a str]) -> Vec<Source<'a>> {
        let source = |(columns, name): (&'a Columns, &&'a str)| Source { name, columns, is_sparse: false };
        columns.iter().zip(names).map(source).collect()
    }

    #[test]
    fn a_star_stands_for_any_characters() {
        for (pattern, name, expected) in [
            ("drive.*", "drive.speed_rad_s", true),
            ("drive.*", "twist_rad", false),
            ("*_rad", "twist_rad", true),
            ("*_rad", "speed_rad_s", false),
            ("*position*", "load_position_rad", true),
            ("a*b*c", "abbc", true),
            ("a*b*c", "acb", false),
            ("*", "", true),
            ("torque_nm", "torque_nm", true),
        ] {
            assert_eq!(is_match(pattern, name), expected, "{pattern} {name}");
        }
    }

    #[test]
    fn signals_of_a_pattern_are_grouped_by_unit() {
        let table = columns(&[("drive.a", "rad"), ("drive.b", "N m"), ("drive.c", "rad"), ("x", "rad")]);
        let tables = [table];
        let panels = together(&sources(&tables, &["one"]), &["drive.*".to_owned()]).expect("panels");
        let labels: Vec<Vec<&str>> =
            panels.iter().map(|panel| panel.series.iter().map(|it| &*it.label).collect()).collect();
        assert_eq!(labels, [vec!["drive.a", "drive.c"], vec!["one"]]);
        assert_eq!((&*panels[0].y_axis.unit, &*panels[1].title), ("rad", "drive.b"));
    }

    #[test]
    fn every_curve_of_a_panel_has_its_own_colour_or_dash() {
        let signals = [
            ("a", "rad"),
            ("b", "rad"),
            ("c", "rad"),
            ("d", "rad"),
            ("e", "rad"),
            ("f", "rad"),
            ("g", "rad"),
        ];
        let tables = [columns(&signals), columns(&signals), columns(&signals)];
        let panels =
            together(&sources(&tables, &["one", "two", "three"]), &["*".to_owned()]).expect("panels");
        assert_eq!(panels.iter().map(|panel| panel.series.len()).collect::<Vec<_>>(), [15, 6]);
        for panel in &panels {
            for (at, series) in panel.series.iter().enumerate() {
                assert!(panel.series[..at].iter().all(|other| other.role != series.role), "{}", series.label);
            }
        }
        assert_eq!(panels[0].series[1].label, "a, two");
    }

    #[test]
    fn a_sparse_signal_is_joined_across_its_gaps() {
        let table = columns(&[("drive.a", "rad")]);
        let source = Source { name: "capture", columns: &table, is_sparse: true };
        assert_eq!(source.points(table.get("drive.a").expect("a column")), (vec![0.0], vec![1.0]));
    }
}
