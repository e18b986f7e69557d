//! Figures over many plants, law by law.

use std::fmt::Write as _;
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

use super::case::Figures;
use super::laws::Law;

/// A figure of the table.
#[derive(Debug)]
pub struct Column {
    name: &'static str,
    unit: &'static str,
    /// The unit per SI unit.
    per_si: f64,
    decimals: usize,
    of: fn(&Figures) -> Option<f64>,
}

const SETTLING: Column =
    Column { name: "settling time", unit: "s", per_si: 1.0, decimals: 2, of: |it| Some(it.settle_time_s) };
const OVERSHOOT: Column =
    Column { name: "overshoot", unit: "mrad", per_si: 1e3, decimals: 1, of: |it| Some(it.overshoot_rad) };
const HUNTING: Column =
    Column { name: "hunting", unit: "mrad", per_si: 1e3, decimals: 1, of: |it| Some(it.hunting_rad) };
const VARIATION: Column = Column {
    name: "variation",
    unit: "N m",
    per_si: 1.0,
    decimals: 0,
    of: |it| Some(it.torque_variation_nm),
};
const GAP: Column = Column {
    name: "abs(j_hat - j0)",
    unit: "mrad",
    per_si: 1e3,
    decimals: 0,
    of: |it| it.dead_zone_error_rad,
};

/// The table of the nominal plant, and of those of the battery.
pub const ORDINARY: &[Column] = &[
    SETTLING,
    OVERSHOOT,
    Column {
        name: "static error",
        unit: "mrad",
        per_si: 1e3,
        decimals: 2,
        of: |it| Some(it.static_error_rad),
    },
    HUNTING,
    VARIATION,
    Column { name: "effort", unit: "N^2 m^2 s", per_si: 1.0, decimals: 0, of: |it| Some(it.effort_nm2s) },
    GAP,
];

/// The table of the harder battery.
pub const HARD: &[Column] = &[
    SETTLING,
    Column { name: "over the minimum", unit: "times", per_si: 1.0, decimals: 2, of: |it| it.over_minimum },
    OVERSHOOT,
    HUNTING,
    VARIATION,
    GAP,
];

/// Figures of one law over the plants of the table.
#[derive(Debug)]
pub struct Row {
    pub law: Law,
    pub figures: Vec<Figures>,
}

/// The table in Markdown: 95 % quantile and maximum of each figure, or the figure alone for a single plant, and the number of
/// plants on which the load never settled or the run was cut short. A published law with a better figure than the best of
/// Lashloop's own is marked by an asterisk; a tie is none.
#[must_use]
pub fn markdown(columns: &[Column], rows: &[Row]) -> String {
    let mut text = String::from("| law |");
    for Column { name, unit, .. } in columns {
        let _ = write!(text, " {name}, {unit} |");
    }
    text += " not settled |\n|---|";
    text += &"---|".repeat(columns.len() + 1);
    for row in rows {
        let _ = write!(text, "\n| `{}` |", row.law.name);
        for column in columns {
            let cells: Vec<_> = quantiles(row, column)
                .into_iter()
                .enumerate()
                .map(|(quantile, value)| {
                    let best_of_ours = rows
                        .iter()
                        .filter(|it| it.law.ours)
                        .filter_map(|it| quantiles(it, column).get(quantile)?.ok_or(()).ok());
                    let best_of_ours = best_of_ours.min_by(f64::total_cmp);
                    cell(column, value, !row.law.ours && beats(column, value, best_of_ours))
                })
                .collect();
            let _ = write!(text, " {} |", cells.join(" / "));
        }
        let never = row.figures.iter().filter(|figures| figures.settle_time_s.is_infinite()).count();
        let _ = write!(text, " {never} |");
    }
    text + "\n"
}

/// Compared as printed: a difference that the table doesn't show is none.
fn beats(column: &Column, value: Option<f64>, best_of_ours: Option<f64>) -> bool {
    let (Some(value), Some(ours)) = (value, best_of_ours) else { return false };
    value < ours && number(column, value) != number(column, ours)
}

fn number(column: &Column, value: f64) -> String {
    if value.is_finite() {
        format!("{:.*}", column.decimals, value * column.per_si)
    } else {
        "none".to_string()
    }
}

fn cell(column: &Column, value: Option<f64>, better: bool) -> String {
    let Some(value) = value else { return "-".to_string() };
    let mark = if better { "*" } else { "" };
    format!("{}{mark}", number(column, value))
}

/// By nearest rank, as the campaigns of `lashloop paper battery`.
fn quantiles(row: &Row, column: &Column) -> Vec<Option<f64>> {
    let mut values: Vec<_> = row.figures.iter().filter_map(column.of).collect();
    values.sort_by(f64::total_cmp);
    match row.figures.len() {
        1 => std::vec![values.first().copied()],
        plants => [(plants * 19).div_ceil(20), plants].map(|rank| values.get(rank - 1).copied()).to_vec(),
    }
}
