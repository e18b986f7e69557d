//! What the page of a campaign shows, aggregated while its table is read. Its size depends on the campaign file, not on the
//! number of runs.

use lashloop_plant::metrics::Metric;

use crate::error::CampaignError;
use crate::failures::FailureAxis;
use crate::limit::Limits;
use crate::map::{Grid, Measure};
use crate::quantile::Sorted;
use crate::report::{Observer, Report};
use crate::settings::{CampaignFile, Limit, Part, Statistic};
use crate::table::{Row, Table};

/// Most points of a distribution, and of all distributions together.
const POINTS: usize = 100;
const MOST_POINTS: usize = 200_000;
/// Most cells of a grid, and of all grids of a campaign.
const CELLS: usize = 1_024;
const MOST_CELLS: usize = 6_000;

/// A report with what its page draws.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    pub report: Report,
    /// Columns with a value: those with a limit or of the evidence first, then in the order of the table.
    pub columns: Vec<ColumnView>,
    pub axes: Vec<FailureAxis>,
    /// Parts with maps.
    pub maps: Vec<PartMaps>,
}

/// A metric or derived column.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnView {
    pub name: String,
    /// Empty for a derived column that is a ratio.
    pub unit: String,
    /// By group of the report.
    pub limits: Vec<Option<Limit>>,
    /// By group of the report.
    pub distributions: Vec<Distribution>,
}

/// Magnitudes with the fraction of runs that are no worse, both ascending. Each point is a run; of many runs, those at equal
/// distances of rank. The last fraction is below 1 if runs have no value.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Distribution {
    pub points: Vec<[f64; 2]>,
}

/// The maps of a part: grids of each measure, by variant.
#[derive(Debug, Clone, PartialEq)]
pub struct PartMaps {
    /// Index of the part.
    pub part: usize,
    pub measures: Vec<MeasureMaps>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct MeasureMaps {
    /// Name of the column; `None` for failures.
    pub column: Option<String>,
    pub unit: String,
    measure: Measure,
    /// By variant.
    pub grids: Vec<Grid>,
    /// By variant.
    pub limits: Vec<Option<Limit>>,
}

impl Distribution {
    fn new(sorted: &Sorted, most: usize) -> Self {
        let (values, runs) = (sorted.values(), sorted.len() as f64);
        let count = values.len().min(most);
        let ranks = (1..=count).map(|point| (point * values.len()).div_ceil(count));
        let mut points: Vec<_> = ranks.map(|rank| [values[rank - 1], rank as f64 / runs]).collect();
        // The best run, from which a curve starts.
        if count < values.len() {
            points.insert(0, [values[0], 1.0 / runs]);
        }
        Self { points }
    }
}

struct Collector<'a> {
    table: &'a Table<'a>,
    /// By group.
    limits: Vec<Limits>,
    /// By column, then by group.
    distributions: Vec<Vec<Distribution>>,
    axes: Vec<FailureAxis>,
    maps: Vec<PartMaps>,
}

impl View {
    /// # Errors
    /// The table can't be read, or is not that of its campaign.
    pub fn new(table: &Table<'_>) -> Result<Self, CampaignError> {
        let mut collector = Collector::new(table)?;
        let report = Report::observed(table, &mut collector)?;
        let Collector { limits, mut distributions, axes, mut maps, .. } = collector;
        for part in &mut maps {
            part.measures.retain(|it| it.grids.iter().any(|grid| grid.values().next().is_some()));
        }
        maps.retain(|part| !part.measures.is_empty());
        let (first, mut order) = (judged(table, &limits), Vec::new());
        for column in first.into_iter().chain(0..table.columns.numbers.len()) {
            if !order.contains(&column) {
                order.push(column);
            }
        }
        let columns = order.into_iter().map(|column| ColumnView {
            name: table.columns.numbers[column].clone(),
            unit: unit(&table.campaign.file, column).to_owned(),
            limits: limits.iter().map(|limits| limits.columns[column]).collect(),
            distributions: std::mem::take(&mut distributions[column]),
        });
        let has_value = |it: &ColumnView| it.distributions.iter().any(|it| !it.points.is_empty());
        Ok(Self { report, columns: columns.filter(has_value).collect(), axes, maps })
    }
}

/// The unit of a column: that of its metric, none after a division.
fn unit(file: &CampaignFile, column: usize) -> &'static str {
    let derived = column.checked_sub(Metric::ALL.len()).and_then(|at| file.derived.get(at));
    match (Metric::ALL.get(column), derived) {
        (Some(metric), _) => metric.unit(),
        (None, Some(derived)) if derived.per.is_none() && derived.or_count_of.is_none() => {
            derived.metric.unit()
        }
        _ => "",
    }
}

/// Columns of expectations, of the evidence, and with a limit of the scenario, in this order.
fn judged(table: &Table<'_>, limits: &[Limits]) -> Vec<usize> {
    let file = &table.campaign.file;
    let expected = file.expectations.iter().filter_map(|it| match &it.what {
        Statistic::Quantile { column, .. } => Some(column),
        Statistic::Pass { .. } => None,
    });
    let named = expected.chain(&file.evidence.of);
    let named = named.filter_map(|name| table.columns.numbers.iter().position(|number| number == name));
    let limited =
        (0..table.columns.numbers.len()).filter(|at| limits.iter().any(|it| it.columns[*at].is_some()));
    named.chain(limited).collect()
}

impl<'a> Collector<'a> {
    fn new(table: &'a Table<'a>) -> Result<Self, CampaignError> {
        let campaign = table.campaign;
        let (parts, variants) = (&campaign.file.parts, campaign.variants.len());
        let groups = (0..parts.len()).flat_map(|part| (0..variants).map(move |variant| (part, variant)));
        let limits = groups.map(|(part, variant)| Limits::new(campaign, part, variant));
        let limits = limits.collect::<Result<Vec<_>, _>>()?;
        let axes = parts.iter().enumerate().flat_map(|(at, part)| FailureAxis::of(at, part, variants));
        let mut columns = judged(table, &limits);
        columns.dedup();
        let maps = maps(table, &limits, &columns);
        let distributions = vec![Vec::new(); table.columns.numbers.len()];
        Ok(Self { table, axes: axes.collect(), distributions, maps, limits })
    }
}

/// Empty grids of the failures and of as many columns as the cells permit.
fn maps(table: &Table<'_>, limits: &[Limits], columns: &[usize]) -> Vec<PartMaps> {
    let (campaign, file) = (table.campaign, &table.campaign.file);
    let variants = campaign.variants.len();
    let parts = file.parts.iter().filter(|part| Grid::of(part, CELLS).is_some()).count();
    // A grid of few cells still has a few on each of its axes.
    let most = CELLS.min(MOST_CELLS / (parts * variants).max(1)).max(64);
    let mut measures = vec![Measure::Failures];
    for column in columns.iter().map(|column| Measure::Column(*column)) {
        if !measures.contains(&column)
            && (measures.len() + 1) * parts * variants * most.min(256) <= MOST_CELLS
        {
            measures.push(column);
        }
    }
    let of_part = |(at, part): (usize, &Part)| {
        let grid = Grid::of(part, (MOST_CELLS / (parts * variants * measures.len()).max(1)).min(most))?;
        let measures = measures.iter().map(|measure| MeasureMaps {
            column: match measure {
                Measure::Failures => None,
                Measure::Column(column) => Some(table.columns.numbers[*column].clone()),
            },
            unit: match measure {
                Measure::Failures => String::new(),
                Measure::Column(column) => unit(file, *column).to_owned(),
            },
            measure: *measure,
            grids: vec![grid.clone(); variants],
            limits: (0..variants).map(|it| limits[at * variants + it].of_measure(*measure)).collect(),
        });
        Some(PartMaps { part: at, measures: measures.collect() })
    };
    file.parts.iter().enumerate().filter_map(of_part).collect()
}

impl Observer for Collector<'_> {
    fn row(&mut self, _: usize, row: &Row<'_>) -> Result<(), String> {
        let plan = &self.table.campaign.plan;
        let (part, number, variant) = plan.place(row.case);
        let has_failed = row.verdict() != "PASS";
        for axis in self.axes.iter_mut().filter(|axis| axis.part == part) {
            axis.push(plan, number, variant, has_failed);
        }
        for maps in self.maps.iter_mut().filter(|maps| maps.part == part) {
            for measure in &mut maps.measures {
                let cell = measure.measure.of(row).ok_or("a field is neither a number nor a reason")?;
                measure.grids[variant].push(number, cell);
            }
        }
        Ok(())
    }

    fn column(&mut self, column: usize, groups: &[Sorted]) {
        let curves = self.table.columns.numbers.len() * groups.len();
        let most = (MOST_POINTS / curves.max(1)).clamp(4, POINTS);
        self.distributions[column] = groups.iter().map(|sorted| Distribution::new(sorted, most)).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Missing;

    #[test]
    fn distribution_has_runs_at_equal_distances_and_ends_below_one_if_runs_have_no_value() {
        let sorted = |values: u32, never: u64| {
            let mut missing = [0; Missing::ALL.len()];
            missing[Missing::Never as usize] = never;
            Sorted::new((1..=values).rev().map(f64::from).collect(), missing)
        };
        let points = |sorted: &Sorted, most| Distribution::new(sorted, most).points;
        assert_eq!(points(&sorted(3, 1), 100), [[1.0, 0.25], [2.0, 0.5], [3.0, 0.75]]);
        assert_eq!(points(&sorted(8, 2), 2), [[1.0, 0.1], [4.0, 0.4], [8.0, 0.8]]);
        assert_eq!(points(&sorted(0, 5), 100), Vec::<[f64; 2]>::new());
        assert_eq!(points(&sorted(100_000, 0), 100).len(), 101);
    }
}
