//! The order of the motions, and what each one decides for the next.

use super::limits::{Exceeded, Guard, Halt, Limits, Peaks};
use super::motions::{self, Breakaway, PlannedMotion, Pulse};
use crate::identified::Identified;
use crate::identify::{IdentifyError, Start, identify};
use crate::series::{Instruments, Series};
use crate::signs::{Directions, contradict, directions};

/// Load motion that shows breakaway, in counts, and in rad if that is more.
const BREAKAWAY_COUNTS: f64 = 4.0;
const BREAKAWAY_RAD: f64 = 0.004;
/// Fraction of the torque limit up to which the motions of the fit go: an amplifier that saturates at the limit takes its offset
/// away there, in one direction only, and the model knows nothing of that.
const HEADROOM: f64 = 0.95;
/// Fraction of the travel that the pulses aim for.
const TRAVEL: f64 = 0.25;
/// Fraction of a speed limit from which the pulses don't grow: the next would be up to twice as fast.
const SPEED: f64 = 0.5;
/// Most sizes that a pulse grows by at once.
const GROWTH_MAX: i32 = 3;
/// Attempts at a motion of a drive train that is not at rest yet.
const ATTEMPTS: u32 = 200;
/// Excess of the twist that is explained over the one that is expected.
const TWIST_MARGIN: f64 = 2.0;
/// Height of a pulse in breakaway torques from which pulses don't grow: the shaft would wind far.
const BREAKAWAYS_MAX: f64 = 5.0;

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

/// Result of a commissioning.
#[derive(Debug, Clone)]
pub struct Commissioned {
    /// Directions of the encoders.
    pub directions: Directions,
    /// Torques of breakaway at the motor.
    pub breakaway: Breakaway,
    /// The motions that the estimates are from, by name.
    pub records: Vec<(String, Series)>,
    /// The estimates.
    pub identified: Identified,
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

/// Makes all motions and estimates the drive train from them.
///
/// # Errors
/// See [`CommissioningError`].
pub fn commission<T: DriveTrain>(
    drive_train: &mut T,
    instruments: &Instruments,
    limits: &Limits,
    period_us: u32,
    start: &Start,
) -> Result<Commissioned, CommissioningError<T::Error>> {
    let period_s = f64::from(period_us) / 1e6;
    let ratio = start.mechanics.ratio;
    let mut bench = Bench { drive_train, instruments, limits, period_s, ratio, origin: None, wound: None };
    let (forward, forward_nm) = bench.breakaway(1.0)?;
    let (backward, backward_nm) = bench.breakaway(-1.0)?;
    let shown = [&forward, &backward].map(|it| directions(std::slice::from_ref(it)));
    if contradict(shown[0], shown[1]) {
        return Err(CommissioningError::Directions { forward: shown[0], backward: shown[1] });
    }
    let breakaway = Breakaway { forward_nm, backward_nm };
    bench.wound = Some(Wound {
        torque_nm: forward_nm.min(backward_nm),
        twist_rad: bench.twist_rad(&[&forward, &backward]),
    });
    let mut records = Vec::new();
    for motion in [motions::slow_reversal(&breakaway, period_s), motions::steps(&breakaway, period_s)] {
        let made = bench.make(&motion, None)?;
        records.push((motion.name, made.series));
    }
    records.push(bench.pulses(&breakaway)?);
    let series: Vec<_> = records.iter().map(|(_, series)| series.clone()).collect();
    let identified = identify(&series, instruments, start)?;
    Ok(Commissioned { directions: identified.directions, breakaway, records, identified })
}

struct Bench<'a, T> {
    drive_train: &'a mut T,
    instruments: &'a Instruments,
    limits: &'a Limits,
    period_s: f64,
    /// Reduction ratio near which the estimation starts.
    ratio: f64,
    /// Load counts at the first sample of all.
    origin: Option<i64>,
    /// `None` before the ramps.
    wound: Option<Wound>,
}

/// How far a torque has turned the motor against a load at rest.
struct Wound {
    torque_nm: f64,
    twist_rad: f64,
}

impl<T: DriveTrain> Bench<'_, T> {
    fn make(
        &mut self,
        motion: &PlannedMotion,
        load_counts: Option<i64>,
    ) -> Result<Made, CommissioningError<T::Error>> {
        let guard = Guard::new(*self.limits, self.instruments, self.period_s, self.origin, load_counts);
        // A ramp ends with the motion of the load, and isn't part of the fit.
        let is_ramp = load_counts.is_some();
        let limit_nm = if is_ramp { self.limits.torque_nm } else { HEADROOM * self.limits.torque_nm };
        let torque_nm: Vec<f64> = motion.torque_nm.iter().map(|it| it.clamp(-limit_nm, limit_nm)).collect();
        let twist_rad = self.explained_twist_rad(&torque_nm);
        let limited = PlannedMotion { name: motion.name.clone(), torque_nm, twist_rad };
        let motion = motion.name.clone();
        for _ in 0..ATTEMPTS {
            let made = self.drive_train.make(&limited, guard.clone()).map_err(CommissioningError::Motion)?;
            let Some(made) = made else { continue };
            self.origin.get_or_insert(made.series.load_counts()[0]);
            return match made.halt {
                Some(Halt::Exceeded(exceeded)) => Err(CommissioningError::Exceeded { motion, exceeded }),
                _ => Ok(made),
            };
        }
        Err(CommissioningError::NotAtRest { motion, attempts: ATTEMPTS })
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
    fn twist_rad(&self, series: &[&Series]) -> f64 {
        let counts = series.iter().map(|it| excursion(it.motor_counts())).max().unwrap_or(0);
        counts as f64 / self.instruments.motor_counts_per_rad()
    }

    /// Ramps the torque until the load moves. Returns the motion with the torque reached.
    fn breakaway(&mut self, sign: f64) -> Result<(Series, f64), CommissioningError<T::Error>> {
        let motion = motions::ramp(self.limits.torque_nm, sign, self.period_s);
        // Noise moves two readings apart by twice its amplitude.
        let counts = BREAKAWAY_COUNTS.max(BREAKAWAY_RAD * self.instruments.load_counts_per_rad())
            + 2.0 * self.instruments.noise_counts;
        let made = self.make(&motion, Some(counts.ceil() as i64))?;
        if made.halt.is_none() {
            let motor_counts = excursion(made.series.motor_counts());
            let torque_nm = self.limits.torque_nm;
            return Err(CommissioningError::NoBreakaway { motion: motion.name, torque_nm, motor_counts });
        }
        let load = made.series.load_counts();
        let left = load.iter().rposition(|count| (count - load[0]).abs() <= 1).unwrap_or(0);
        let torque_nm = made.series.torque_nm()[left].abs();
        Ok((made.series, torque_nm))
    }

    /// Pulses, each larger than the one before, until the load travels far enough. Returns the last one.
    fn pulses(&mut self, breakaway: &Breakaway) -> Result<(String, Series), CommissioningError<T::Error>> {
        let mut pulse = Pulse { breakaways: 1.3, duration_s: 0.1 };
        let (mut index, mut last, mut before) = (1, None, None);
        loop {
            let motion = motions::pulses(breakaway, &pulse, index, self.period_s);
            let Made { series, peaks, .. } = match (self.make(&motion, None), last) {
                (Ok(made), _) => made,
                // The pulse before was within the limits.
                (Err(CommissioningError::Exceeded { .. }), Some(last)) => return Ok(last),
                (Err(error), _) => return Err(error),
            };
            let Limits { motor_speed_rad_s, load_speed_rad_s, load_travel_rad, .. } = *self.limits;
            let is_large = peaks.load_travel_rad > TRAVEL * load_travel_rad
                || peaks.motor_speed_rad_s > SPEED * motor_speed_rad_s
                || peaks.load_speed_rad_s > SPEED * load_speed_rad_s;
            if is_large || pulse.breakaways >= BREAKAWAYS_MAX {
                return Ok((motion.name, series));
            }
            last = Some((motion.name, series));
            for _ in 0..before.map_or(1, |before| growth(&before, &peaks, self.limits)) {
                pulse = pulse.grown();
            }
            before = Some(peaks);
            index += 1;
        }
    }
}

/// Sizes by which the next pulse may grow: a size more multiplies travel and speeds by no more than the last growth did,
/// because a pulse barely beyond breakaway gains the most.
fn growth(before: &Peaks, peaks: &Peaks, limits: &Limits) -> i32 {
    const FACTOR_MIN: f64 = 1.25;
    let sizes = |before: f64, reached: f64, aim: f64| {
        let factor = (reached / before.max(1e-9)).max(FACTOR_MIN);
        (aim / reached.max(1e-9)).log(factor).floor() as i32
    };
    let travel = sizes(before.load_travel_rad, peaks.load_travel_rad, TRAVEL * limits.load_travel_rad);
    let motor = sizes(before.motor_speed_rad_s, peaks.motor_speed_rad_s, SPEED * limits.motor_speed_rad_s);
    let load = sizes(before.load_speed_rad_s, peaks.load_speed_rad_s, SPEED * limits.load_speed_rad_s);
    travel.min(motor).min(load).clamp(1, GROWTH_MAX)
}

fn excursion(counts: &[i64]) -> i64 {
    counts.iter().map(|count| (count - counts[0]).abs()).max().unwrap_or(0)
}
