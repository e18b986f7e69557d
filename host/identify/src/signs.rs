//! Directions of both encoders.
//!
//! A drive train that begins at rest can't return more energy than its motor has supplied. So the work of the torques on
//! the motor's counts is positive, in a closed loop as well, if the encoder counts in the direction of the torque. The
//! same holds for the load, whose friction and inertia take what the transmission passes on.

use crate::series::Series;

/// Direction in which an encoder counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Counts rise under a positive torque.
    Forward,
    /// Counts fall under a positive torque.
    Reverse,
}

impl Direction {
    /// 1 or -1.
    #[must_use]
    pub fn sign(self) -> i64 {
        match self {
            Self::Forward => 1,
            Self::Reverse => -1,
        }
    }

    fn of(value: f64) -> Self {
        if value < 0.0 { Self::Reverse } else { Self::Forward }
    }
}

/// Directions of both encoders; `None` if the encoder barely moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Directions {
    /// Of the motor encoder relative to the torque.
    pub motor: Option<Direction>,
    /// Of the load encoder relative to the torque.
    pub load: Option<Direction>,
}

/// Fewest counts of motion that show a direction: one count is the quantisation, the second one noise of an edge.
const COUNTS_MIN: f64 = 3.0;

/// Length of a block of the work, in s.
const BLOCK_S: f64 = 0.02;

/// Whether two motions show different directions of an encoder.
#[must_use]
pub fn contradict(one: Directions, other: Directions) -> bool {
    let differ = |pair: (Option<Direction>, Option<Direction>)| matches!(pair, (Some(one), Some(other)) if one != other);
    differ((one.motor, other.motor)) || differ((one.load, other.load))
}

/// Directions from one or more motions, each of which begins at rest.
#[must_use]
pub fn directions(series: &[Series]) -> Directions {
    // The work that quantisation can feign: a motion of some counts under the largest torque.
    let doubt = series.iter().map(|it| COUNTS_MIN * it.peak_nm()).fold(0.0, f64::max);
    let of = |readings: fn(&Series) -> &[i64]| {
        let work: f64 = series.iter().map(|it| work_nm_counts(it, readings(it))).sum();
        (work.abs() > doubt).then(|| Direction::of(work))
    };
    Directions { motor: of(Series::motor_counts), load: of(Series::load_counts) }
}

/// Work of the torques in N m counts, by blocks: a loop answers the jitter of single counts with torques against it, a
/// period or two late. The torque that holds the drive train only balances what would move it.
fn work_nm_counts(series: &Series, counts: &[i64]) -> f64 {
    let block = ((BLOCK_S / series.period_s()).round() as usize).max(1);
    let (last, held_nm) = (counts.len() - 1, series.held_nm());
    let work = (0..last).step_by(block).map(|from| {
        let until = (from + block).min(last);
        let torque_nm = series.torque_nm()[from..until].iter().sum::<f64>() / (until - from) as f64 - held_nm;
        torque_nm * (counts[until] - counts[from]) as f64
    });
    work.sum()
}
