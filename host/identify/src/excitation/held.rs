//! The torque that holds a drive train at rest: an offset of the torque moves it without one.

use super::bench::{Bench, CommissioningError, DriveTrain, Made, excursion};
use super::limits::{Guard, Halt};
use super::motions::{self, Breakaway};

/// Duration of a held torque; a drive train at rest doesn't move in the second half of it.
const HELD_S: f64 = 1.2;
/// Step of the torques that are held in search of a rest, as a fraction of the torque limit, and how many there are of each sign.
const HELD_STEP: f64 = 0.0025;
const HELD_STEPS: u32 = 20;
/// Speed after a held torque over the speed before, below which the same torque is held again, and how often at most.
const SLOWER: f64 = 0.8;
const HELD_AGAIN: u32 = 10;
/// Torque of breakaway in one direction over that in the other, from which the offset of the torque makes the difference.
const UNEQUAL: f64 = 3.0;

/// What a held torque does to motor and load.
struct Drift {
    /// Counts by which each moves in the first and in the second half of the time.
    moved: [[f64; 2]; 2],
    /// Counts between which an encoder at rest may jump.
    edge: f64,
}

impl Drift {
    fn new(counts: [&[i64]; 2], edge: f64) -> Self {
        let moved = counts.map(|counts| {
            let (first, second) = counts.split_at(counts.len() / 2);
            [first, second].map(|it| excursion(it) as f64)
        });
        Self { moved, edge }
    }

    fn is_still(&self) -> bool {
        self.moved.iter().all(|[_, last]| *last <= self.edge)
    }

    /// Whether the motor moves slower than before, and the load as well unless it coasts within the gap.
    fn slows(&self) -> bool {
        let slows = |[first, last]: [f64; 2]| last <= self.edge.max(SLOWER * first);
        let [motor, load] = self.moved;
        slows(motor) && (motor[1] <= self.edge || slows(load))
    }
}

impl<T: DriveTrain> Bench<'_, T> {
    /// Holds a torque for a while.
    fn held(&mut self, torque_nm: f64) -> Result<Drift, CommissioningError<T::Error>> {
        self.held += 1;
        let motion = motions::held(torque_nm, self.held, HELD_S, self.period_s);
        let guard = Guard::new(*self.limits, self.instruments, self.period_s, self.origin, None);
        let made =
            self.drive_train.make(&motion, guard.without_rest()).map_err(CommissioningError::Motion)?;
        let Some(Made { series, halt, .. }) = made else {
            return Err(CommissioningError::NotAtRest { motion: motion.name, attempts: 1 });
        };
        self.origin.get_or_insert(series.load_counts()[0]);
        if let Some(Halt::Exceeded(exceeded)) = halt {
            return Err(CommissioningError::RunsAway { motion: motion.name, exceeded, torque_nm });
        }
        let edge_counts = 1.0 + 2.0 * self.instruments.noise_counts;
        Ok(Drift::new([series.motor_counts(), series.load_counts()], edge_counts))
    }

    /// Whether the drive train rests under a torque, or comes to rest. Otherwise by how many counts more the motor moves than at the
    /// end of the torque before: a heavy load gains speed under the better of two torques too.
    fn drifts(&mut self, torque_nm: f64) -> Result<Option<f64>, CommissioningError<T::Error>> {
        let mut drift = self.held(torque_nm)?;
        for _ in 0..HELD_AGAIN {
            if drift.is_still() {
                self.drift_counts = 0.0;
                return Ok(None);
            }
            if !drift.slows() {
                break;
            }
            drift = self.held(torque_nm)?;
        }
        let before = std::mem::replace(&mut self.drift_counts, drift.moved[0][1]);
        Ok(Some(self.drift_counts - before))
    }

    pub(super) fn rests(&mut self) -> Result<bool, CommissioningError<T::Error>> {
        Ok(self.drifts(0.0)?.is_none())
    }

    /// Finds the torques that the drive train rests under and holds the one in their middle: an offset of the torque moves it
    /// without one. Which sign works against the motion shows after one torque of each.
    pub(super) fn hold(&mut self) -> Result<(), CommissioningError<T::Error>> {
        let mut signs = vec![1.0, -1.0];
        let step_nm = HELD_STEP * self.limits.torque_nm;
        let mut first_nm = None;
        for steps in 1..=HELD_STEPS {
            let mut drifts = Vec::new();
            for sign in std::mem::take(&mut signs) {
                let torque_nm = sign * f64::from(steps) * step_nm;
                match (self.drifts(torque_nm)?, first_nm) {
                    (None, first) => {
                        let first_nm = *first_nm.insert(first.unwrap_or(torque_nm));
                        self.held_nm = 0.5 * (first_nm + torque_nm);
                        drifts = vec![(0.0, sign)];
                        break;
                    }
                    (Some(_), Some(_)) => return Ok(()),
                    (Some(moved), None) => drifts.push((moved, sign)),
                }
            }
            drifts.sort_by(|a, b| a.0.total_cmp(&b.0));
            signs = vec![drifts[0].1];
        }
        let torque_nm = f64::from(HELD_STEPS) * step_nm;
        if first_nm.is_some() { Ok(()) } else { Err(CommissioningError::Drifts { torque_nm }) }
    }

    /// Torques of breakaway from the held torque on. If they are far from equal, an offset takes part of the friction, and a
    /// torque nearer to their middle is held from now on. A ramp may pass the breakaway of a heavy load by far, so the drive train
    /// has to rest under it.
    pub(super) fn centre(
        &mut self,
        forward_nm: f64,
        backward_nm: f64,
    ) -> Result<Breakaway, CommissioningError<T::Error>> {
        let breakaway = Breakaway { forward_nm, backward_nm };
        if forward_nm.max(backward_nm) < UNEQUAL * forward_nm.min(backward_nm) {
            return Ok(breakaway);
        }
        for part in [0.5, 0.25, 0.125] {
            let shift_nm = part * (forward_nm - backward_nm);
            match self.drifts(self.held_nm + shift_nm) {
                Ok(None) => {
                    self.held_nm += shift_nm;
                    let (forward_nm, backward_nm) = (forward_nm - shift_nm, backward_nm + shift_nm);
                    return Ok(Breakaway { forward_nm, backward_nm });
                }
                Ok(Some(_)) => {}
                // What the ramps have measured holds without it.
                Err(CommissioningError::RunsAway { .. }) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(breakaway)
    }
}
