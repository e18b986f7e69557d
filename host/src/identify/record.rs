//! Torques and counts from the columns of a record.
//!
//! A record of HIL mode has the true positions, one of bench mode those that the encoders showed. Both give the counts, up
//! to a constant: the encoder counts down to the integer below.

use std::f64::consts::TAU;

use lashloop_bench::names::UnknownName;
use lashloop_identify::{Instruments, Series, SeriesError};
use lashloop_record::columns::Columns;

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

/// The series of a record.
///
/// # Errors
/// A column is missing, or the series is too short.
pub fn series(columns: &Columns, instruments: &Instruments) -> Result<Series, NoSeries> {
    let column = |name: &str| {
        let known = || columns.signals().iter().map(|signal| &*signal.name);
        columns.get(name).ok_or_else(|| UnknownName::new("the record", "column", name, known()))
    };
    let time_s = column("time_s")?;
    let elapsed_s = time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first);
    let period_us = 1e6 * elapsed_s / time_s.len().saturating_sub(1).max(1) as f64;
    let read = |name, counts_per_rev| -> Result<Vec<i64>, NoSeries> {
        Ok(column(name)?.iter().map(|&position_rad| counts(position_rad, counts_per_rev)).collect())
    };
    Ok(Series::new(
        period_us.round() as u32,
        column("torque_nm")?.to_vec(),
        read("motor_position_rad", instruments.motor_counts_per_rev)?,
        read("load_position_rad", instruments.load_counts_per_rev)?,
    )?)
}
