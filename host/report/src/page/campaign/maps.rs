//! Maps over two axes of a grid: their cells, colours and iso-lines for the script of the page.

use lashloop_campaign::cell::Cell;
use lashloop_campaign::map::{Grid, Map, Over};
use lashloop_campaign::settings::Limit;
use lashloop_campaign::view::{MeasureMaps, PartMaps};
use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use super::super::typeset::{self, percent};
use super::distributions::tick;
use super::input::{CampaignResults, limit, quantity};

/// Most cells of all maps, so that the page stays below 1 MB.
const MOST_CELLS: usize = 24_000;

#[derive(Serialize)]
struct PartData {
    name: String,
    variants: Vec<String>,
    axes: Vec<AxisData>,
    measures: Vec<MeasureData>,
    pairs: Vec<[usize; 2]>,
    /// By pair.
    slices: Vec<Vec<String>>,
    /// By measure, pair, slice and variant.
    maps: Vec<Vec<Vec<Vec<MapData>>>>,
}

#[derive(Serialize)]
struct AxisData {
    name: String,
    ticks: Vec<String>,
}

#[derive(Serialize)]
struct MeasureData {
    name: String,
    /// By variant.
    limits: Vec<Option<String>>,
}

#[derive(Serialize)]
struct MapData {
    cells: Vec<String>,
    /// One digit for each cell; `n` without a value.
    levels: String,
    /// Ends of the segments of the iso-line: x, y, x, y.
    lines: Vec<f64>,
}

pub(in super::super) fn section(results: &CampaignResults<'_>) -> Markup {
    let mut left = MOST_CELLS;
    let parts: Vec<_> = results.view.maps.iter().map(|part| data(results, part, &mut left)).collect();
    // Text of others may hold the end of a script element.
    let json = serde_json::to_string(&parts).unwrap_or_else(|_| "[]".to_owned()).replace('<', "\\u003c");
    html! {
        section #maps {
            h2 { "Maps" }
            div.map-place { noscript { "The maps need JavaScript." } }
            p.note {
                "Blue cells meet the limit, orange ones don't, and grey ones have no value. The line is where the value, interpolated \
                 between cells, has the limit; it passes halfway to a cell without a value. The limit is that of the campaign, or else of the scenario; \
                 without one on the fraction of passes, half of the runs may fail."
            }
            script type="application/json" id="map-data" { (PreEscaped(json)) }
        }
    }
}

fn data(results: &CampaignResults<'_>, part: &PartMaps, left: &mut usize) -> PartData {
    let grid = &part.measures[0].grids[0];
    let axes = grid.axes.iter().map(|axis| AxisData {
        name: quantity(&axis.label, &axis.unit, axis.times.as_deref()),
        ticks: axis
            .ticks
            .iter()
            .map(|[first, last]| match first == last {
                true => tick(first),
                false => format!("{}\u{2013}{}", tick(first), tick(last)),
            })
            .collect(),
    });
    let count = grid.axes.len();
    let all_pairs = (0..count).flat_map(|x| (x + 1..count).map(move |y| [x, y]));
    let numbers = part.measures.len() * results.campaign.variants.len();
    let (mut pairs, mut slices) = (Vec::new(), Vec::new());
    for pair in all_pairs {
        let cells = numbers * grid.axes[pair[0]].ticks.len() * grid.axes[pair[1]].ticks.len();
        let mut of_pair = all_slices(grid, pair);
        // The first map is there in any case.
        let least = usize::from(pairs.is_empty());
        of_pair.truncate((*left / cells.max(1)).max(least));
        *left = left.saturating_sub(cells * of_pair.len());
        if !of_pair.is_empty() {
            pairs.push(pair);
            slices.push(of_pair);
        }
    }
    let maps = part.measures.iter().map(|measure| {
        let of_slice = |pair: [usize; 2], slice: &Slice| {
            let grids = measure.grids.iter().zip(&measure.limits);
            grids
                .map(|(grid, limit)| {
                    map(
                        &grid.map(pair, &slice.ticks, slice.over),
                        *limit,
                        span(grid),
                        measure.column.is_none(),
                    )
                })
                .collect()
        };
        let pairs = pairs.iter().zip(&slices);
        pairs.map(|(pair, slices)| slices.iter().map(|slice| of_slice(*pair, slice)).collect()).collect()
    });
    let maps = maps.collect();
    PartData {
        name: results.campaign.file.parts[part.part].name.clone(),
        variants: results.campaign.variants.iter().map(|it| it.name.clone()).collect(),
        axes: axes.collect(),
        measures: part.measures.iter().map(measure).collect(),
        slices: slices.into_iter().map(|of_pair| of_pair.into_iter().map(|it| it.name).collect()).collect(),
        pairs,
        maps,
    }
}

fn measure(measure: &MeasureMaps) -> MeasureData {
    let name = match &measure.column {
        None => "fraction of runs that fail".to_owned(),
        Some(column) => quantity(column, &measure.unit, None),
    };
    let unit = typeset::unit(&measure.unit);
    let text =
        |bound: &Option<Limit>| bound.map(|bound| format!("{} {unit}", limit(bound)).trim_end().to_owned());
    MeasureData { name, limits: measure.limits.iter().map(text).collect() }
}

/// A choice of the further axes.
struct Slice {
    name: String,
    ticks: Vec<Option<usize>>,
    over: Over,
}

/// Worst and mean over all further axes, then each of their ticks.
fn all_slices(grid: &Grid, pair: [usize; 2]) -> Vec<Slice> {
    let further: Vec<_> = (0..grid.axes.len()).filter(|axis| !pair.contains(axis)).collect();
    let all = vec![None; grid.axes.len()];
    let names: Vec<_> = further.iter().map(|axis| grid.axes[*axis].label.as_str()).collect();
    let over = |word: &str, over| Slice {
        name: format!("{word} over {}", names.join(", ")),
        ticks: all.clone(),
        over,
    };
    if further.is_empty() {
        return vec![Slice { name: String::new(), ticks: all, over: Over::Mean }];
    }
    let mut slices = vec![over("worst", Over::Worst), over("mean", Over::Mean)];
    let combinations: usize = further.iter().map(|axis| grid.axes[*axis].ticks.len()).product();
    for combination in 0..combinations {
        let (mut rest, mut ticks, mut words) = (combination, all.clone(), Vec::new());
        for axis in further.iter().rev() {
            let count = grid.axes[*axis].ticks.len();
            let chosen = rest % count;
            rest /= count;
            ticks[*axis] = Some(chosen);
            words.insert(
                0,
                format!("{} {}", grid.axes[*axis].label, tick(&grid.axes[*axis].ticks[chosen][0])),
            );
        }
        slices.push(Slice { name: words.join(", "), ticks, over: Over::Mean });
    }
    slices
}

/// Least and largest value of a grid.
fn span(grid: &Grid) -> [f64; 2] {
    let ends = [f64::INFINITY, f64::NEG_INFINITY];
    grid.values().fold(ends, |[low, high], value| [low.min(value), high.max(value)])
}

fn map(map: &Map, limit: Option<Limit>, span: [f64; 2], is_fraction: bool) -> MapData {
    let text = |cell: &Option<Cell>| match cell {
        None => String::new(),
        Some(Cell::Missing(reason)) => reason.word().to_owned(),
        Some(Cell::Value(0.0)) if is_fraction => "0".to_owned(),
        Some(Cell::Value(value)) if is_fraction => percent(*value),
        Some(Cell::Value(value)) => typeset::shown(format!("{value:.2e}").parse().unwrap_or(*value)),
    };
    let lines = limit.map(|limit| map.iso_lines(limit)).unwrap_or_default();
    // A thousandth of a cell is less than a pixel.
    let rounded = |value: f64| (value * 1e3).round() / 1e3;
    MapData {
        cells: map.cells.iter().map(text).collect(),
        levels: map.cells.iter().map(|cell| level(*cell, limit, span)).collect(),
        lines: lines.into_iter().flatten().flatten().map(rounded).collect(),
    }
}

/// The colour of a cell: with a limit 0 to 3 from the least value to the limit, and 4 to 7 up to twice the limit. Without a limit
/// 0 to 3 from the least value to the largest.
fn level(cell: Option<Cell>, limit: Option<Limit>, [low, high]: [f64; 2]) -> char {
    let Some(cell @ Cell::Value(value)) = cell else { return 'n' };
    const SHADES: f64 = 4.0;
    let shade = |from: f64, to: f64| {
        if to > from { ((value - from) / (to - from) * SHADES).clamp(0.0, SHADES - 1.0) as u32 } else { 0 }
    };
    let level = match limit {
        Some(limit) if limit.is_met(cell) => shade(low, limit.value()),
        Some(limit) => SHADES as u32 + shade(limit.value(), high.min(2.0 * limit.value())),
        None => shade(low, high),
    };
    char::from_digit(level, 10).unwrap_or('n')
}
