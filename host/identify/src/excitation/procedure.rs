//! The order of the motions, and what each one decides for the next.

use super::bench::{Bench, CommissioningError, DriveTrain, Made, Wound, excursion};
use super::limits::{Limits, Peaks};
use super::motions::{self, Breakaway, Pulse};
use crate::identified::Identified;
use crate::identify::{Start, identify};
use crate::series::{Instruments, Series};
use crate::signs::{Directions, contradict, directions};

/// Load motion that shows breakaway, in counts, and in rad if that is more.
const BREAKAWAY_COUNTS: f64 = 4.0;
const BREAKAWAY_RAD: f64 = 0.004;
/// Fraction of the travel that the pulses aim for.
const TRAVEL: f64 = 0.25;
/// Fraction of a speed limit from which the pulses don't grow: the next would be up to twice as fast.
const SPEED: f64 = 0.5;
/// Most sizes that a pulse grows by at once.
const GROWTH_MAX: i32 = 3;
/// Height of a pulse in breakaway torques from which pulses don't grow: the shaft would wind far.
const BREAKAWAYS_MAX: f64 = 5.0;

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
    let mut bench = Bench {
        drive_train,
        instruments,
        limits,
        period_s,
        ratio,
        origin,
        wound,
        held_nm: 0.0,
        held: 0,
        drift_counts: 0.0,
    };
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

impl<T: DriveTrain> Bench<'_, T> {
    fn ramps(&mut self) -> Result<[(Series, f64); 2], CommissioningError<T::Error>> {
        Ok([self.breakaway(1.0)?, self.breakaway(-1.0)?])
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
