//! The order of the motions, and what each one decides for the next.

use super::limits::{Exceeded, Guard, Halt, Limits, Peaks, REST_S};
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
/// Time in which a drive train comes to rest before a motion, and before a ramp, in s.
const COASTS_S: f64 = 15.0;
const COASTS_BEFORE_RAMP_S: f64 = 5.0;
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
    /// Torque that holds the drive train at rest, from which the torques of breakaway count. 0 for one that rests without.
    pub held_nm: f64,
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
    /// The drive train moves under every torque that was held.
    #[error(
        "the drive train moves without torque and under each torque up to {torque_nm} N m either way: an offset of the torque or a \
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
    let (origin, wound) = (None, None);
    let mut bench =
        Bench { drive_train, instruments, limits, period_s, ratio, origin, wound, held_nm: 0.0, held: 0 };
    if !bench.rests()? {
        bench.hold()?;
    }
    let ramps = match bench.ramps() {
        // It came to rest once, but creeps now that it has moved.
        Err(CommissioningError::NotAtRest { .. }) if bench.held_nm == 0.0 => {
            bench.hold()?;
            bench.ramps()
        }
        ramps => ramps,
    };
    let [(forward, forward_nm), (backward, backward_nm)] = ramps?;
    let shown = [&forward, &backward].map(|it| directions(std::slice::from_ref(it)));
    if contradict(shown[0], shown[1]) {
        return Err(CommissioningError::Directions { forward: shown[0], backward: shown[1] });
    }
    let breakaway = bench.centre(forward_nm, backward_nm)?;
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
    let held_nm = bench.held_nm;
    Ok(Commissioned { directions: identified.directions, breakaway, held_nm, records, identified })
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
    /// Torque that holds the drive train, on top of every motion: it rests under it.
    held_nm: f64,
    /// Number of torques that were held in search of it.
    held: u32,
}

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
        let coasts_s = if load_counts.is_some() { COASTS_BEFORE_RAMP_S } else { COASTS_S };
        let attempts = (coasts_s / REST_S) as u32;
        let guard = Guard::new(*self.limits, self.instruments, self.period_s, self.origin, load_counts);
        // A ramp ends with the motion of the load, and isn't part of the fit.
        let is_ramp = load_counts.is_some();
        let limit_nm = if is_ramp { self.limits.torque_nm } else { HEADROOM * self.limits.torque_nm };
        let limited_nm = |it: &f64| (self.held_nm + it).clamp(-limit_nm, limit_nm);
        let torque_nm: Vec<f64> = motion.torque_nm.iter().map(limited_nm).collect();
        let twist_rad = self.explained_twist_rad(&torque_nm);
        let limited = PlannedMotion { name: motion.name.clone(), torque_nm, twist_rad };
        let motion = motion.name.clone();
        for _ in 0..attempts {
            let made = self.drive_train.make(&limited, guard.clone()).map_err(CommissioningError::Motion)?;
            let Some(made) = made else { continue };
            self.origin.get_or_insert(made.series.load_counts()[0]);
            return match made.halt {
                Some(Halt::Exceeded(exceeded)) => Err(CommissioningError::Exceeded { motion, exceeded }),
                _ => Ok(made),
            };
        }
        Err(CommissioningError::NotAtRest { motion, attempts })
    }

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
            return Err(CommissioningError::Exceeded { motion: motion.name, exceeded });
        }
        let edge_counts = 1.0 + 2.0 * self.instruments.noise_counts;
        Ok(Drift::new([series.motor_counts(), series.load_counts()], edge_counts))
    }

    /// Whether the drive train rests under a torque, or comes to rest. Otherwise how far the motor still moves, in counts.
    fn drifts(&mut self, torque_nm: f64) -> Result<Option<f64>, CommissioningError<T::Error>> {
        let mut drift = self.held(torque_nm)?;
        for _ in 0..HELD_AGAIN {
            if drift.is_still() {
                return Ok(None);
            }
            if !drift.slows() {
                break;
            }
            drift = self.held(torque_nm)?;
        }
        Ok(Some(drift.moved[0][1]))
    }

    fn rests(&mut self) -> Result<bool, CommissioningError<T::Error>> {
        Ok(self.drifts(0.0)?.is_none())
    }

    /// Finds the torques that the drive train rests under and holds the one in their middle: an offset of the torque moves it
    /// without one. Which sign works against the motion shows after one torque of each.
    fn hold(&mut self) -> Result<(), CommissioningError<T::Error>> {
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

    fn ramps(&mut self) -> Result<[(Series, f64); 2], CommissioningError<T::Error>> {
        Ok([self.breakaway(1.0)?, self.breakaway(-1.0)?])
    }

    /// Torques of breakaway from the held torque on. If they are far from equal, an offset takes part of the friction, and a
    /// torque nearer to their middle is held from now on. A ramp may pass the breakaway of a heavy load by far, so the drive train
    /// has to rest under it.
    fn centre(
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
            if self.drifts(self.held_nm + shift_nm)?.is_none() {
                self.held_nm += shift_nm;
                let (forward_nm, backward_nm) = (forward_nm - shift_nm, backward_nm + shift_nm);
                return Ok(Breakaway { forward_nm, backward_nm });
            }
        }
        Ok(breakaway)
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
        let torque_nm = (made.series.torque_nm()[left] - self.held_nm).abs();
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
