//! Torques and counts from the columns of a record.
//!
//! A record of HIL mode has the true positions, one of bench mode those that the encoders showed. Both give the counts, up
//! to a constant: the encoder counts down to the integer below.

use std::f64::consts::TAU;

use lashloop_bench::scenario::RunMode;
use lashloop_identify::{Direction, Instruments, Series, SeriesError};
use lashloop_record::columns::Columns;
use lashloop_session::names::UnknownName;

/// Far below a count, and far above the rounding of a position that is a whole number of counts.
const ROUNDING_COUNTS: f64 = 1e-6;

/// Why a record gives no series.
#[derive(Debug, thiserror::Error)]
pub enum NoSeries {
    /// A column is missing.
    #[error("{}: {}", .0.name, .0)]
    Column(#[from] UnknownName),
    /// The columns are unusable.
    #[error(transparent)]
    Series(#[from] SeriesError),
}

/// The count of an encoder at a position.
#[must_use]
pub fn counts(position_rad: f64, counts_per_rev: u32) -> i64 {
    (position_rad * f64::from(counts_per_rev) / TAU + ROUNDING_COUNTS).floor() as i64
}

/// Directions of motor and load that a drive had in force in a run: its reports have them applied. `choice` is the choice in
/// force of a parameter. In HIL mode the counts are those of the bench, and no direction applies.
#[must_use]
pub fn directions_in_force(mode: RunMode, choice: impl Fn(&str) -> Option<String>) -> [Direction; 2] {
    ["motor_direction", "load_direction"].map(|name| {
        let is_reversed = !mode.is_hil() && choice(name).as_deref() == Some("reverse");
        if is_reversed { Direction::Reverse } else { Direction::Forward }
    })
}

/// The series of a record, in counts as the encoders are wired: what they show is the setting that a drive needs, for any that
/// it had in force.
///
/// # Errors
/// A column is missing, or the series is too short.
pub fn series(
    columns: &Columns,
    instruments: &Instruments,
    in_force: [Direction; 2],
) -> Result<Series, NoSeries> {
    let column = |name: &str| {
        let known = || columns.signals().iter().map(|signal| &*signal.name);
        columns.get(name).ok_or_else(|| UnknownName::new("the record", "column", name, known()))
    };
    let time_s = column("time_s")?;
    let elapsed_s = time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first);
    let period_us = 1e6 * elapsed_s / time_s.len().saturating_sub(1).max(1) as f64;
    let read = |name, counts_per_rev, in_force: Direction| -> Result<Vec<i64>, NoSeries> {
        let wired = |&position_rad: &f64| in_force.sign() * counts(position_rad, counts_per_rev);
        Ok(column(name)?.iter().map(wired).collect())
    };
    let [motor, load] = in_force;
    Ok(Series::new(
        period_us.round() as u32,
        column("torque_nm")?.to_vec(),
        read("motor_position_rad", instruments.motor_counts_per_rev, motor)?,
        read("load_position_rad", instruments.load_counts_per_rev, load)?,
    )?)
}
