//! Panels that the user chooses, in front of the others.

use super::data::{Chart, Data, PER_CHART, Series, coloured};
use super::input::Run;
use crate::chosen::{self, Group, Source};
use crate::draw_error::DrawError;

/// Signals that are shown together; none by default.
#[derive(Debug, Clone, Default)]
pub struct Panels(Vec<Group>);

impl Panels {
    /// A panel for each list of names and each unit in it. In a name `*` stands for any characters.
    ///
    /// # Errors
    /// No run has a signal of one of the names, or two have it in different units.
    pub fn of(runs: &[Run], lists: &[Vec<String>]) -> Result<Self, DrawError> {
        let source = |run| {
            let Run { name, record, .. }: &Run = run;
            Source { name, columns: &record.trace, is_sparse: false }
        };
        let sources: Vec<_> = runs.iter().map(source).collect();
        // A chart has as many curves as colours, with dashes twice as many.
        let most = (2 * PER_CHART / runs.len().max(1)).clamp(1, PER_CHART);
        let groups = lists.iter().map(|names| chosen::groups(&sources, names, most));
        Ok(Self(groups.collect::<Result<Vec<_>, _>>()?.concat()))
    }

    /// Adds the charts: a curve for each signal of each run.
    pub(super) fn draw(&self, data: &mut Data, runs: &[Run]) {
        for Group { title, unit, names } in &self.0 {
            let mut series = Vec::new();
            for name in names {
                for (number, run) in runs.iter().enumerate() {
                    let Some(values) = run.column(name) else { continue };
                    let id = data.column(number, name, || values.to_vec());
                    let label = match (runs, &names[..]) {
                        ([_], _) => name.clone(),
                        (_, [_]) => run.name.clone(),
                        _ => format!("{name}, {}", run.name),
                    };
                    series.push(coloured(series.len(), Series::new(label, number, id)));
                }
            }
            if !series.is_empty() {
                data.charts.push(Chart::new(title, unit, series));
            }
        }
    }
}
