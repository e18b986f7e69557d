//! A measure of the runs over the axes of a grid: cells, maps of two axes, iso-lines at a limit, and the side of a point.
//!
//! A cell has the magnitude of its run, or the reason for its absence. Between cells a value is interpolated linearly in each
//! axis. A cell without a value misses every limit; the iso-line passes halfway between it and a cell that meets the limit.

use std::cmp::Ordering;

use crate::cell::{Cell, Missing};
pub use crate::grid_axis::{GridAxis, PlaceError};
use crate::limit::Limits;
use crate::row::Columns;
use crate::settings::{Limit, Method, Part};
use crate::table::Row;

/// What of a run a map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// 1 for a run whose verdict is not PASS, else 0.
    Failures,
    /// The magnitude of a column, by its place among the numbers.
    Column(usize),
}

impl Measure {
    /// The column of this name.
    #[must_use]
    pub fn column(columns: &Columns, name: &str) -> Option<Self> {
        columns.numbers.iter().position(|number| number == name).map(Self::Column)
    }

    /// `None` if the table is malformed.
    #[must_use]
    pub fn of(self, row: &Row<'_>) -> Option<Cell> {
        match self {
            Self::Failures => Some(Cell::Value(if row.verdict() == "PASS" { 0.0 } else { 1.0 })),
            Self::Column(column) => row.cell(column).map(Cell::magnitude),
        }
    }
}

/// A measure of one variant over all axes of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    pub axes: Vec<GridAxis>,
    /// The last axis varies fastest, as rows of a part do.
    cells: Vec<Runs>,
}

/// Runs in one cell.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Runs {
    count: u64,
    sum: f64,
    worst: Option<Cell>,
}

impl Runs {
    fn push(&mut self, cell: Cell) {
        self.add(Self { count: 1, sum: cell.value().unwrap_or(0.0), worst: Some(cell) });
    }

    /// Only runs that a derived column omits don't count, unless it omits all.
    fn add(&mut self, other: Self) {
        const OMITTED: Option<Cell> = Some(Cell::Missing(Missing::Omitted));
        match (self.worst, other.worst) {
            (_, None) => {}
            (Some(_), OMITTED) if self.worst != OMITTED => {}
            (None | OMITTED, Some(_)) => *self = other,
            (Some(worst), Some(cell)) => {
                self.count += other.count;
                self.sum += other.sum;
                if cell.order(&worst) == Ordering::Greater {
                    self.worst = Some(cell);
                }
            }
        }
    }

    fn reduced(self, over: Over) -> Option<Cell> {
        match (self.worst?, over) {
            (Cell::Value(_), Over::Mean) => Some(Cell::Value(self.sum / self.count as f64)),
            // A mean of the rest would be too good.
            (worst, _) => Some(worst),
        }
    }
}

/// How runs that share a cell become one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// The largest magnitude; a missing value exceeds every number.
    Worst,
    Mean,
}

impl Grid {
    /// An empty grid of a part; `None` unless its method is `grid` with at least two axes. Neighbouring values of long axes share
    /// a tick until the grid has at most `most_cells`.
    #[must_use]
    pub fn of(part: &Part, most_cells: usize) -> Option<Self> {
        if part.method != Method::Grid || part.axes.len() < 2 {
            return None;
        }
        let mut most_ticks: Vec<u64> = part.axes.iter().map(|axis| axis.values.len()).collect();
        while most_ticks.iter().product::<u64>() > most_cells as u64 {
            let longest = most_ticks.iter_mut().max().filter(|ticks| **ticks > 1)?;
            *longest = longest.div_ceil(2);
        }
        let axes: Vec<_> =
            part.axes.iter().zip(most_ticks).map(|(axis, most)| GridAxis::new(axis, most)).collect();
        let cells = vec![Runs::default(); axes.iter().map(|axis| axis.ticks.len()).product()];
        Some(Self { axes, cells })
    }

    /// Adds a run by its row in the part.
    pub fn push(&mut self, row: u64, cell: Cell) {
        let (mut rest, mut place, mut stride) = (row, 0, 1);
        for axis in self.axes.iter().rev() {
            place += stride * (rest % axis.values / axis.values_per_tick) as usize;
            rest /= axis.values;
            stride *= axis.ticks.len();
        }
        self.cells[place].push(cell);
    }

    /// The worst numbers of the cells that have one.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.cells.iter().filter_map(|cell| cell.worst?.value())
    }

    /// The map of two axes. `slice` has a tick of each axis, or `None` for all of its ticks; those of the two axes don't matter.
    #[must_use]
    pub fn map(&self, [x, y]: [usize; 2], slice: &[Option<usize>], over: Over) -> Map {
        let width = self.axes[x].ticks.len();
        let mut runs = vec![Runs::default(); width * self.axes[y].ticks.len()];
        for (place, cell) in self.cells.iter().enumerate() {
            let ticks = self.ticks(place);
            let is_in =
                |axis: usize| axis == x || axis == y || slice[axis].is_none_or(|tick| tick == ticks[axis]);
            if (0..self.axes.len()).all(is_in) {
                runs[ticks[y] * width + ticks[x]].add(*cell);
            }
        }
        let cells = runs.into_iter().map(|runs| runs.reduced(over)).collect();
        Map { width, cells }
    }

    /// Tick of each axis at a place among the cells.
    fn ticks(&self, mut place: usize) -> Vec<usize> {
        let mut ticks = vec![0; self.axes.len()];
        for (tick, axis) in ticks.iter_mut().zip(&self.axes).rev() {
            *tick = place % axis.ticks.len();
            place /= axis.ticks.len();
        }
        ticks
    }

    fn cell(&self, ticks: &[usize]) -> Option<Cell> {
        let place =
            self.axes.iter().zip(ticks).fold(0, |place, (axis, tick)| place * axis.ticks.len() + tick);
        self.cells[place].reduced(Over::Worst)
    }

    /// The side of the limit on which a point lies: a value for each axis, in its unit.
    ///
    /// # Errors
    /// An axis has values that aren't numbers, or the point is outside the grid.
    pub fn place(&self, point: &[f64], limit: Limit) -> Result<Placed, PlaceError> {
        if point.len() != self.axes.len() {
            return Err(PlaceError::Dimensions { given: point.len(), axes: self.axes.len() });
        }
        let positions = self.axes.iter().zip(point).map(|(axis, value)| axis.position(*value));
        let positions = positions.collect::<Result<Vec<_>, _>>()?;
        let (mut sum, mut worst, mut met, mut missed) = (0.0, Cell::Value(f64::NEG_INFINITY), 0, 0);
        for corner in 0..1_usize << positions.len() {
            let mut weight = 1.0;
            let ticks = positions.iter().enumerate().map(|(axis, (tick, fraction))| {
                let is_next = corner >> axis & 1 == 1;
                weight *= if is_next { *fraction } else { 1.0 - fraction };
                tick + usize::from(is_next)
            });
            let ticks: Vec<_> = ticks.collect();
            // A corner without weight may be outside the grid.
            if weight == 0.0 {
                continue;
            }
            let cell = self.cell(&ticks).unwrap_or(Cell::Missing(Missing::Unmeasured));
            sum += weight * cell.value().unwrap_or(f64::NAN);
            if cell.order(&worst) == Ordering::Greater {
                worst = cell;
            }
            *if limit.is_met(cell) { &mut met } else { &mut missed } += 1;
        }
        let value = match worst {
            Cell::Value(_) => Cell::Value(sum),
            missing @ Cell::Missing(_) => missing,
        };
        let side = match (met, missed, value) {
            (_, 0, _) => Side::Inside,
            (0, ..) => Side::Outside,
            (_, _, Cell::Missing(_)) => Side::Edge,
            _ if limit.is_met(value) => Side::Inside,
            _ => Side::Outside,
        };
        Ok(Placed { side, value })
    }
}

/// Where a point lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    pub side: Side,
    /// Interpolated between the cells that enclose the point; the worst reason if one of them has no value.
    pub value: Cell,
}

/// A side of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The limit is met.
    Inside,
    Outside,
    /// Between cells that meet the limit and cells without a value.
    Edge,
}

/// Cells over two axes of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Ticks of the horizontal axis.
    pub width: usize,
    /// Row by row, in the order of ticks; `None` without a run.
    pub cells: Vec<Option<Cell>>,
}

/// A part of an iso-line from one point to another. Coordinates are ticks: 0 is the middle of the first cell.
pub type Segment = [[f64; 2]; 2];

impl Map {
    /// The border between cells that meet the limit and cells that don't, by marching squares.
    #[must_use]
    pub fn iso_lines(&self, limit: Limit) -> Vec<Segment> {
        let height = self.cells.len() / self.width.max(1);
        let mut segments = Vec::new();
        for y in 1..height {
            for x in 1..self.width {
                // Counter-clockwise from the first tick of both axes.
                let corners = [[x - 1, y - 1], [x, y - 1], [x, y], [x - 1, y]];
                let cells = corners.map(|[x, y]| {
                    self.cells[y * self.width + x].unwrap_or(Cell::Missing(Missing::Unmeasured))
                });
                let crossing = |edge: usize| {
                    let next = (edge + 1) % 4;
                    let along = crossing(cells[edge], cells[next], limit)?;
                    let at = |axis: usize| {
                        let [from, to] = [edge, next].map(|corner| corners[corner][axis] as f64);
                        from + (to - from) * along
                    };
                    Some([at(0), at(1)])
                };
                let crossings = [0, 1, 2, 3].map(crossing);
                match crossings {
                    [Some(a), Some(b), Some(c), Some(d)] => {
                        // Two corners meet the limit, across from each other; the middle joins them or the other two.
                        let sum: Option<f64> = cells.iter().map(|cell| cell.value()).sum();
                        let middle = sum.is_some_and(|sum| limit.is_met(Cell::Value(sum / 4.0)));
                        let joins_first = middle == limit.is_met(cells[0]);
                        segments.extend(if joins_first { [[a, b], [c, d]] } else { [[d, a], [b, c]] });
                    }
                    _ => {
                        let mut ends = crossings.into_iter().flatten();
                        segments.extend(ends.next().zip(ends.next()).map(|(from, to)| [from, to]));
                    }
                }
            }
        }
        segments
    }
}

/// How far from the first to the second cell the limit is crossed, 0 to 1.
fn crossing(first: Cell, second: Cell, limit: Limit) -> Option<f64> {
    if limit.is_met(first) == limit.is_met(second) {
        return None;
    }
    Some(match (first, second) {
        (Cell::Value(first), Cell::Value(second)) => (limit.value() - first) / (second - first),
        _ => 0.5,
    })
}

impl Limits {
    /// The limit of a measure. Without an expectation on the fraction of passes, half of the runs may fail.
    #[must_use]
    pub fn of_measure(&self, measure: Measure) -> Option<Limit> {
        match measure {
            Measure::Failures => Some(self.failures.unwrap_or(Limit::Max(0.5))),
            Measure::Column(column) => self.columns.get(column).copied().flatten(),
        }
    }
}

#[cfg(test)]
mod tests;
