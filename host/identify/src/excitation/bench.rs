//! A drive train that makes motions, and how each of them is limited and repeated.

use super::limits::{Exceeded, Guard, Halt, LEAD_IN_S, LONG_REST_S, Limits, Peaks, REST_S};
use super::motions::PlannedMotion;
use crate::identify::IdentifyError;
use crate::series::{Held, Instruments, Series, SeriesError};
use crate::signs::Directions;

/// Fraction of the torque limit up to which the motions of the fit go: an amplifier that saturates at the limit takes its offset
/// away there, in one direction only, and the model knows nothing of that.
const HEADROOM: f64 = 0.95;
/// Time in which a drive train comes to rest before a motion, and before a ramp, in s.
const COASTS_S: f64 = 15.0;
const COASTS_BEFORE_RAMP_S: f64 = 5.0;
/// Part of that time in which a drive train that starts anew has to be at rest for longer. Some never are: a count in that time.
const PATIENCE: f64 = 0.5;
/// Excess of the twist that is explained over the one that is expected.
const TWIST_MARGIN: f64 = 2.0;

/// A drive train that makes motions: a bench with hardware, or a model of one.
pub trait DriveTrain {
    /// Why a motion can't be made.
    type Error;

    /// Makes a motion from rest, and gives every sample to the guard before its torque is commanded. A halt ends the
    /// motion and the torque. `None` after [`Halt::NotAtRest`]: the motion has not begun.
    ///
    /// # Errors
    /// The motion can't be made or recorded.
    fn make(&mut self, motion: &PlannedMotion, guard: Guard) -> Result<Option<Made>, Self::Error>;

    /// Whether each motion begins at the same state. A longer time at rest then shows a load that creeps there. Otherwise a drive train
    /// begins where the motion before has ended, and in a longer time it comes to rest less often: plant 7001 of virtual silicon never.
    fn starts_anew(&self) -> bool {
        true
    }
}

/// A motion that was made.
#[derive(Debug, Clone)]
pub struct Made {
    /// Torques and counts up to its end.
    pub series: Series,
    /// Why it ended early; `None` if it was made to its end.
    pub halt: Option<Halt>,
    /// Largest values.
    pub peaks: Peaks,
}

/// Why a commissioning has no result.
#[derive(Debug, thiserror::Error)]
pub enum CommissioningError<E> {
    /// A motion could not be made.
    #[error(transparent)]
    Motion(E),
    /// A limit is exceeded, and the torque is off.
    #[error("{motion}: {exceeded}; raise the limit if the machine bears more, or lower the torque limit")]
    Exceeded {
        /// The motion.
        motion: String,
        /// The limit.
        exceeded: Exceeded,
    },
    /// The load stays at rest up to the torque limit.
    #[error(
        "{motion}: the load did not move up to {torque_nm} N m, the motor by {motor_counts} counts; raise the torque limit, or \
         check brake, power stage and load encoder"
    )]
    NoBreakaway {
        /// The motion.
        motion: String,
        /// Largest torque.
        torque_nm: f64,
        /// Largest excursion of the motor.
        motor_counts: i64,
    },
    /// What a motion shows is too short.
    #[error("{motion}: {source}")]
    Series {
        /// The motion.
        motion: String,
        /// What it lacks.
        source: SeriesError,
    },
    /// A limit is exceeded without a torque, or under one against the motion.
    #[error(
        "{motion}: {exceeded} under {torque_nm} N m: an offset of the torque or a weight drives the load; take the offset away, balance the \
         load, or raise the limit if the machine bears more"
    )]
    RunsAway {
        /// The motion.
        motion: String,
        /// The limit.
        exceeded: Exceeded,
        /// The torque that was held.
        torque_nm: f64,
    },
    /// The drive train doesn't come to rest.
    #[error(
        "{motion}: the drive train moves without torque, {attempts} times in a row; wait until it is at rest, or fasten the load"
    )]
    NotAtRest {
        /// The motion.
        motion: String,
        /// Attempts.
        attempts: u32,
    },
    /// The drive train moves under every torque that was held.
    #[error(
        "the drive train moves without torque and under each torque up to {torque_nm} N m against the motion: an offset of the torque or a \
         weight drives it; take the offset away, balance the load, or raise the torque limit"
    )]
    Drifts {
        /// Largest torque.
        torque_nm: f64,
    },
    /// The two ramps contradict each other.
    #[error(
        "the ramps show different directions of the encoders, {forward:?} and {backward:?}; check the wiring of A and B"
    )]
    Directions {
        /// Of the ramp forward.
        forward: Directions,
        /// Of the ramp backward.
        backward: Directions,
    },
    /// The motions don't show the drive train.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}

pub(super) struct Bench<'a, T> {
    pub(super) drive_train: &'a mut T,
    pub(super) instruments: &'a Instruments,
    pub(super) limits: &'a Limits,
    pub(super) period_s: f64,
    /// Reduction ratio near which the estimation starts.
    pub(super) ratio: f64,
    /// Load counts at the first sample of all.
    pub(super) origin: Option<i64>,
    /// `None` before the ramps.
    pub(super) wound: Option<Wound>,
    /// Torque that holds the drive train, on top of every motion: it rests under it.
    pub(super) held_nm: f64,
    /// Number of torques that were held in search of it.
    pub(super) held: u32,
    /// Counts by which the motor moved at the end of the latest of them.
    pub(super) drift_counts: f64,
}

/// How far a torque has turned the motor against a load at rest.
pub(super) struct Wound {
    pub(super) torque_nm: f64,
    pub(super) twist_rad: f64,
}

impl<T: DriveTrain> Bench<'_, T> {
    pub(super) fn make(
        &mut self,
        motion: &PlannedMotion,
        load_counts: Option<i64>,
    ) -> Result<Made, CommissioningError<T::Error>> {
        let coasts_s = if load_counts.is_some() { COASTS_BEFORE_RAMP_S } else { COASTS_S };
        let guard = Guard::new(*self.limits, self.instruments, self.period_s, self.origin, load_counts);
        // A ramp ends with the motion of the load, and isn't part of the fit.
        let is_ramp = load_counts.is_some();
        let limit_nm = if is_ramp { self.limits.torque_nm } else { HEADROOM * self.limits.torque_nm };
        let limited_nm = |it: &f64| (self.held_nm + it).clamp(-limit_nm, limit_nm);
        let mut attempts = 0;
        let mut waited_s = 0.0;
        while waited_s < coasts_s {
            let is_patient = self.drive_train.starts_anew() && waited_s < PATIENCE * coasts_s;
            let (held, rest_s) = self.begin(is_patient);
            let guard = match held {
                Some(_) if self.held_nm != 0.0 => guard.clone().held(),
                Some(_) => guard.clone().patient(),
                None => guard.clone(),
            };
            // The motion has the shorter time at rest.
            let longer = std::iter::repeat_n(&0.0, ((rest_s - REST_S) / self.period_s).round() as usize);
            let torque_nm: Vec<f64> = longer.chain(&motion.torque_nm).map(limited_nm).collect();
            let twist_rad = self.explained_twist_rad(&torque_nm);
            let planned = PlannedMotion { name: motion.name.clone(), torque_nm, twist_rad, held };
            let made = self.drive_train.make(&planned, guard).map_err(CommissioningError::Motion)?;
            (attempts, waited_s) = (attempts + 1, waited_s + rest_s);
            let Some(Made { series, halt, peaks }) = made else { continue };
            let motion = planned.name;
            self.origin.get_or_insert(series.load_counts()[0]);
            if let Some(Halt::Exceeded(exceeded)) = halt {
                return Err(CommissioningError::Exceeded { motion, exceeded });
            }
            let series = held.map_or(Ok(series.clone()), |held| series.held(held));
            let series = series.map_err(|source| CommissioningError::Series { motion, source })?;
            return Ok(Made { series, halt, peaks });
        }
        Err(CommissioningError::NotAtRest { motion: motion.name.clone(), attempts })
    }

    /// How a motion begins, and its time at rest with the lead-in. The fit gets the end of that time alone, where the load creeps least.
    fn begin(&self, is_patient: bool) -> (Option<Held>, f64) {
        let held = |lead_in_s: f64| Some(Held { torque_nm: self.held_nm, lead_in_s });
        match self.held_nm {
            0.0 if is_patient => (held(LONG_REST_S - REST_S), LONG_REST_S),
            0.0 => (None, REST_S),
            _ => (held(LEAD_IN_S), LEAD_IN_S + LONG_REST_S),
        }
    }

    /// The shaft winds in proportion to the torque. Where the direction of an encoder is reversed, travel of the load
    /// appears as twist.
    fn explained_twist_rad(&self, torque_nm: &[f64]) -> Option<f64> {
        let Wound { torque_nm: wound_nm, twist_rad } = self.wound.as_ref()?;
        let peak_nm = torque_nm.iter().fold(*wound_nm, |peak, it| peak.max(it.abs()));
        let travel_rad = self.ratio * self.limits.load_travel_rad;
        Some(TWIST_MARGIN * (peak_nm / wound_nm * twist_rad + travel_rad))
    }

    /// Largest excursion of the motor in these motions, in rad.
    pub(super) fn twist_rad(&self, series: &[&Series]) -> f64 {
        let counts = series.iter().map(|it| excursion(it.motor_counts())).max().unwrap_or(0);
        counts as f64 / self.instruments.motor_counts_per_rad()
    }
}

pub(super) fn excursion(counts: &[i64]) -> i64 {
    counts.iter().map(|count| (count - counts[0]).abs()).max().unwrap_or(0)
}
