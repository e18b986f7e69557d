//! The trajectory of a closed loop, and what every report reads from it.

use lashloop_plant::Truth;

/// The band, in rad, whose settling time reproduces the paper's transient times.
const BAND_RAD: f64 = 0.05;

/// One sample of a trajectory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Row {
    pub(crate) time_s: f64,
    pub(crate) truth: Truth,
    pub(crate) torque_nm: f64,
    pub(crate) dead_zone_estimate_rad: f64,
}

/// First sample time after the last sample outside the band of 0.05 rad around zero; `None` if the last one is outside.
pub(crate) fn settle_s(rows: &[Row]) -> Option<f64> {
    let outside = rows.iter().rposition(|row| row.truth.load_position_rad.abs() > BAND_RAD);
    rows.get(outside.map_or(0, |k| k + 1)).map(|row| row.time_s)
}

/// Sum of |U_k - U_(k-1)| in N m.
pub(crate) fn torque_variation_nm(rows: &[Row]) -> f64 {
    rows.windows(2).map(|pair| (pair[1].torque_nm - pair[0].torque_nm).abs()).sum()
}

/// Largest distance between the load positions of two runs in rad.
pub(crate) fn load_distance_rad(one: &[Row], other: &[Row]) -> f64 {
    let pairs = one.iter().zip(other);
    pairs.map(|(a, b)| (a.truth.load_position_rad - b.truth.load_position_rad).abs()).fold(0.0, f64::max)
}

/// Lost motion in rad over 80 s of [`slow_sine`](crate::closed_loop::slow_sine) at 1 kHz: how far apart the load is at the
/// last two passages of the reference through zero.
pub(crate) fn lost_motion_rad(rows: &[Row]) -> f64 {
    (rows[80_000].truth.load_position_rad - rows[70_000].truth.load_position_rad).abs()
}
