//! A line on a map, and a map, as text.

use std::fmt;

use crate::cell::{Cell, Missing};
use crate::expectation::shown;
use crate::map::{PlaceError, Placed, Side};
use lashloop_plant::metrics::Metric;

use super::line_map::{Border, LineMap, VariantMap};
use super::point::Point;

/// A point on the map of each variant.
#[derive(Debug)]
pub struct Placement<'a> {
    map: &'a LineMap,
    point: Point,
    variants: Vec<PlacedVariant<'a>>,
}

#[derive(Debug)]
struct PlacedVariant<'a> {
    variant: &'a VariantMap,
    placed: Placed,
    margin: Margin,
}

#[derive(Debug)]
enum Margin {
    /// How far delay, jitter and loss may rise.
    Inside([Border; 3]),
    Outside {
        longest_delay_us: Option<f64>,
    },
}

impl<'a> Placement<'a> {
    /// # Errors
    /// The point is beyond the map.
    pub fn new(map: &'a LineMap, point: Point) -> Result<Self, PlaceError> {
        let variants = map.variants.iter().map(|variant| {
            let placed = variant.place(point)?;
            let margin = match placed.side {
                Side::Inside => Margin::Inside(variant.borders(point)?),
                // Between a cell that meets the limit and one without a value nothing was measured.
                Side::Outside | Side::Edge => {
                    Margin::Outside { longest_delay_us: variant.longest_delay_us(point)? }
                }
            };
            Ok(PlacedVariant { variant, placed, margin })
        });
        Ok(Self { map, point, variants: variants.collect::<Result<_, _>>()? })
    }

    /// Whether the point is inside for every law, or for this one.
    #[must_use]
    pub fn is_inside(&self, law: Option<&str>) -> bool {
        let mut chosen = self
            .variants
            .iter()
            .filter(|it| law.is_none_or(|law| it.variant.scenario.controller.name == law));
        chosen.all(|it| matches!(it.margin, Margin::Inside(_)))
    }
}

impl fmt::Display for Placement<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Point { delay_us, jitter_us, loss } = self.point;
        let metric = &self.map.metric;
        writeln!(out, "{:<15}delay {delay_us:.0} us, jitter {jitter_us:.0} us, loss {loss}", "point")?;
        write!(out, "{:<15}{}: {metric} over delay, jitter and loss", "map", self.map.name)?;
        for PlacedVariant { variant, placed, margin } in &self.variants {
            let side = if matches!(margin, Margin::Inside(_)) { "inside" } else { "OUTSIDE" };
            let (value, limit) = (with_unit(placed.value, metric), Cell::Value(variant.limit.value()));
            let limit = with_unit(limit, metric);
            write!(out, "\n{:<15}{side:<9}{value}, limit {limit}; ", variant.name)?;
            match margin {
                Margin::Inside(borders) => {
                    out.write_str("margin ")?;
                    let names = ["delay", "jitter", "loss"];
                    let units = [" us", " us", ""];
                    for (axis, border) in borders.iter().enumerate() {
                        let (border, or_more) = match *border {
                            Border::At(border) => (border, ""),
                            Border::Edge(edge) => (edge, " or more"),
                        };
                        let (name, unit) = (names[axis], units[axis]);
                        let separator = if axis == 0 { "" } else { ", " };
                        let margin = border - self.point.values()[axis];
                        let digits = if unit.is_empty() { 2 } else { 0 };
                        write!(out, "{separator}{name} +{margin:.digits$}{unit}{or_more}")?;
                    }
                }
                Margin::Outside { longest_delay_us: Some(delay_us) } => {
                    write!(out, "inside up to a delay of {delay_us:.0} us at this jitter and loss")?;
                }
                Margin::Outside { longest_delay_us: None } => {
                    out.write_str("outside at any delay with this jitter and loss")?;
                }
            }
        }
        Ok(())
    }
}

/// Every slice of the map: delay to the right, jitter downwards, both in ms.
impl fmt::Display for LineMap {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "{} over delay (columns) and jitter (rows); * misses the limit, as `never` and `cut` (cut short) do",
            self.metric
        )?;
        for variant in &self.variants {
            let limit = with_unit(Cell::Value(variant.limit.value()), &self.metric);
            let [delays, jitters, losses] = [0, 1, 2].map(|axis| variant.ticks(axis));
            for loss in losses {
                write!(out, "\n\n{}, limit {limit}, loss {loss}\n{:>9}", variant.name, "ms")?;
                delays.iter().try_for_each(|delay_us| write!(out, "{:>7}", delay_us / 1e3))?;
                for jitter_us in &jitters {
                    write!(out, "\n{:>9}", jitter_us / 1e3)?;
                    for delay_us in &delays {
                        let point = Point { delay_us: *delay_us, jitter_us: *jitter_us, loss };
                        let placed = variant.place(point).map_err(|_| fmt::Error)?;
                        write!(out, "{:>7}", in_table(placed, variant))?;
                    }
                }
            }
        }
        Ok(())
    }
}

fn in_table(placed: Placed, variant: &VariantMap) -> String {
    match placed.value {
        Cell::Value(value) => {
            let mark = if variant.limit.is_met(placed.value) { "" } else { "*" };
            format!("{value:.2}{mark}")
        }
        Cell::Missing(Missing::CutShort) => "cut".to_owned(),
        Cell::Missing(reason) => reason.to_string(),
    }
}

fn with_unit(cell: Cell, metric: &str) -> String {
    let metric = Metric::ALL.iter().find(|it| it.name() == metric);
    let unit = metric.map_or("", |metric| metric.unit());
    match cell {
        Cell::Value(_) => format!("{} {unit}", shown(cell)).trim_end().to_owned(),
        Cell::Missing(_) => shown(cell),
    }
}
