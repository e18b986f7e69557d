//! Torques and counts from the columns of a record.
//!
//! A record of bench mode has the positions that the encoders showed. They give the counts, up to a constant: the encoder
//! counts down to the integer below. One of HIL mode has the true positions, which no drive gets, and the counts that the
//! drive got, with eccentricity and noise.

use std::f64::consts::TAU;

use lashloop_bench::scenario::RunMode;
use lashloop_identify::{Direction, Instruments, Series, SeriesError};
use lashloop_protocol::EncoderCounts;
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

/// The counts of an encoder, continued across the wraparound of the wire.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reading {
    last: Option<i64>,
}

impl Reading {
    /// The count that was sent in a step; without one, that of the position.
    pub fn next(&mut self, sent: Option<i64>, of_position: i64) -> i64 {
        let near = self.last.unwrap_or(of_position);
        let reading =
            sent.map_or(of_position, |sent| near + i64::from(EncoderCounts::wrapping(sent - near).get()));
        self.last = Some(reading);
        reading
    }
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
    mode: RunMode,
    in_force: [Direction; 2],
) -> Result<Series, NoSeries> {
    let column = |name: &str| {
        let known = || columns.signals().iter().map(|signal| &*signal.name);
        columns.get(name).ok_or_else(|| UnknownName::new("the record", "column", name, known()))
    };
    let time_s = column("time_s")?;
    let elapsed_s = time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first);
    let period_us = 1e6 * elapsed_s / time_s.len().saturating_sub(1).max(1) as f64;
    let read = |encoder: &str, counts_per_rev, in_force: Direction| -> Result<Vec<i64>, NoSeries> {
        let positions = column(&format!("{encoder}_position_rad"))?;
        let sent = columns.get(&format!("{encoder}_counts")).filter(|_| mode.is_hil());
        let mut reading = Reading::default();
        let read = positions.iter().enumerate().map(|(at, &position_rad)| {
            let sent = sent.map(|it| it[at]).filter(|it| it.is_finite());
            in_force.sign() * reading.next(sent.map(|it| it as i64), counts(position_rad, counts_per_rev))
        });
        Ok(read.collect())
    };
    let [motor, load] = in_force;
    Ok(Series::new(
        period_us.round() as u32,
        column("torque_nm")?.to_vec(),
        read("motor", instruments.motor_counts_per_rev, motor)?,
        read("load", instruments.load_counts_per_rev, load)?,
    )?)
}
