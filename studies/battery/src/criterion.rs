//! The criteria of the battery's tables: a metric or a derived column with name, unit and digits.

use lashloop_campaign::cell::Cell;

use super::campaign::Battery;

/// A column of the tables, which show magnitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// Column of `results.csv`.
    pub column: &'static str,
    pub name: &'static str,
    pub unit: &'static str,
    /// Unit of the table per SI unit.
    per_si: f64,
    decimals: usize,
    /// Whether the sweeps have it.
    pub is_swept: bool,
}

const fn criterion(
    column: &'static str,
    name: &'static str,
    (unit, per_si, decimals): (&'static str, f64, usize),
    is_swept: bool,
) -> Criterion {
    Criterion { column, name, unit, per_si, decimals, is_swept }
}

const MRAD: (&str, f64, usize) = ("mrad", 1e3, 2);
const PERCENT: (&str, f64, usize) = ("%", 1e2, 1);

/// Of the standard battery, in the order of the tables.
const STANDARD: [Criterion; 9] = [
    criterion("settle_time_s", "settle time", ("s", 1.0, 2), true),
    criterion("overshoot_rad", "overshoot", MRAD, true),
    criterion("static_error_rad", "static error", MRAD, true),
    criterion("static_error_bands", "static error", ("bands", 1.0, 2), false),
    criterion("hunting_rad", "hunting", MRAD, true),
    criterion("dead_zone_error_rad", "|j_hat - j0|", MRAD, true),
    criterion("dead_zone_deviation_rad", "sigma(j_hat)", MRAD, true),
    criterion("effort_nm2s", "effort", ("N^2 m^2 s", 1.0, 0), true),
    criterion("torque_total_variation_nm", "variation", ("N m", 1.0, 0), true),
];

/// Settling after moves to and fro, instead of [`OF_ONE_MOVE`].
pub(super) const EVERY_MOVE: &str = "settle_after_every_move_s";

/// Columns that describe a run of one move from its first error to rest.
pub(super) const OF_ONE_MOVE: [&str; 3] = ["settle_time_s", "overshoot_rad", "hunting_rad"];

/// What the harder battery has in addition.
const HARD: [Criterion; 4] = [
    criterion("settle_over_minimum", "over the minimum", ("times", 1.0, 2), true),
    criterion(EVERY_MOVE, "after every move", ("s", 1.0, 2), false),
    criterion("dead_zone_beyond_two_deviations", "beyond 2 sigma", PERCENT, true),
    criterion("dead_zone_beyond_four_deviations", "beyond 4 sigma", PERCENT, true),
];

impl Battery {
    /// The criteria of its tables, in their order.
    pub fn criteria(self) -> impl Iterator<Item = &'static Criterion> {
        let more: &[Criterion] = match self {
            Self::Standard => &[],
            Self::Hard => &HARD,
        };
        STANDARD.iter().chain(more)
    }
}

impl Criterion {
    /// The criterion of a column.
    #[must_use]
    pub fn of(column: &str) -> Option<&'static Self> {
        STANDARD.iter().chain(&HARD).find(|criterion| criterion.column == column)
    }

    /// Formats a value in SI units in the unit of the table.
    #[must_use]
    pub fn show(&self, si: f64) -> String {
        format!("{:.*}", self.decimals, si * self.per_si)
    }

    /// The magnitude in the unit of the table, or the reason for its absence.
    #[must_use]
    pub fn cell(&self, cell: Cell) -> String {
        match cell.magnitude() {
            Cell::Value(magnitude) => self.show(magnitude),
            Cell::Missing(reason) => reason.to_string(),
        }
    }
}
