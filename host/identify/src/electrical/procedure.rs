//! The order of the electrical motions, and what each one has to show before the next.

use super::balance::{Motor, Steps, half_width, motor};
use super::motions::{self, HeldCurrents};
use super::stated::Stated;
use crate::excitation::{Guard, Halt, Limits};
use crate::quantity::Estimate;
use crate::series::Instruments;

/// Part of the confirmed limits at which a motion halts. What it has shown until then counts.
const MARGIN: f64 = 0.5;
/// Currents of the open loop, as parts of the largest: the first that the sensor shows counts.
const OPEN: [f64; 4] = [0.05, 0.1, 0.2, 0.4];
/// Least part of the current that the stated resistance explains.
const SHOWN: f64 = 0.25;
/// Shortest hold of the open loop in s, and in stated time constants L/R: a light motor soon turns.
const OPEN_HOLD_S: f64 = 0.006;
const OPEN_TIME_CONSTANTS: f64 = 4.0;
/// Currents of the closed loop, as parts of the largest.
const CLOSED: [f64; 3] = [0.1, 0.2, 0.4];
/// Shortest hold in s, and in stated time constants L/R.
const HOLD_S: f64 = 0.01;
const HOLD_TIME_CONSTANTS: f64 = 5.0;
/// Hold of a motion whose motor is to turn, in s.
const SPIN_HOLD_S: f64 = 0.06;
const ROUNDS: usize = 3;
/// Attempts at a motion of a motor that is not at rest yet.
const ATTEMPTS: u32 = 200;
/// Largest factor between a stated value and its estimate.
const WRONG: f64 = 1.5;
/// Half widths of R, L and k_e, as parts, that end the motions, and those that are accepted in the end.
const NARROW: [f64; 3] = [0.03, 0.05, 0.02];
const WIDEST: [f64; 3] = [0.1, 0.3, 0.1];

/// A motor on a bridge that makes motions.
pub trait ElectricalTrain {
    /// Why a motion can't be made.
    type Error;

    /// Makes a motion from rest, and gives every sample to the guard. `None` after [`Halt::NotAtRest`].
    ///
    /// # Errors
    /// The motion can't be made or recorded.
    fn hold(&mut self, motion: &HeldCurrents, guard: Guard) -> Result<Option<MadeSteps>, Self::Error>;
}

/// A motion that was made.
#[derive(Debug, Clone)]
pub struct MadeSteps {
    /// All steps up to its end.
    pub steps: Steps,
    /// Load counts at its first and last step.
    pub load_counts: [i64; 2],
    /// Why the guard ended it early.
    pub halt: Option<Halt>,
    /// What the drive switched the bridge off for.
    pub trip: Option<StageTrip>,
}

/// What a drive switches its bridge off for, as far as it says something of the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StageTrip {
    /// The current is not the one that the voltage makes.
    Sensor,
    /// The current is too large.
    Overcurrent,
}

/// A stated value that is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Checked {
    /// The resistance, and with it the scale of the current.
    Resistance,
    /// The torque constant, and with it the scale of the voltage.
    TorqueConstant,
}

impl Checked {
    fn remedy(self) -> &'static str {
        match self {
            Self::Resistance => {
                "a current that is shown too large by a factor makes R too small by it: correct current_range_a, or \
                 motor_resistance_ohm if a second measurement says so"
            }
            Self::TorqueConstant => {
                "k_e comes from voltage and speed alone: correct torque_constant_nm_a, or supply_range_v and \
                 encoders.motor_counts_per_rev if it is on the motor's plate"
            }
        }
    }
}

/// Why a motor has no result. No loop was closed around the load.
#[derive(Debug, thiserror::Error)]
pub enum ElectricalError<E> {
    /// A motion could not be made.
    #[error(transparent)]
    Motion(E),
    /// A voltage makes a current of the opposite sign.
    #[error(
        "{motion}: {voltage_v:.3} V make {current_a:.3} A: the sensor is reversed; set \
         current_direction to the other value"
    )]
    SensorReversed {
        /// The motion.
        motion: String,
        /// Mean voltage at the resistance.
        voltage_v: f64,
        /// Mean current along it.
        current_a: f64,
    },
    /// The sensor shows nothing.
    #[error(
        "{motion}: {voltage_v:.3} V make {current_a:.3} A, and {expected_a:.3} A by motor_resistance_ohm; check the motor's wires, \
         the sensor's pin and current_range_a"
    )]
    NoCurrent {
        /// The motion.
        motion: String,
        /// Mean voltage at the resistance.
        voltage_v: f64,
        /// Mean current along it.
        current_a: f64,
        /// Current by the stated resistance.
        expected_a: f64,
    },
    /// The drive switched the bridge off.
    #[error(
        "{motion}: the drive switched the bridge off, because the sensor shows {}; check current_direction, current_range_a and \
         motor_resistance_ohm",
        match trip { StageTrip::Sensor => "another current than the voltage makes", StageTrip::Overcurrent => "more than 1.5 times current_limit_a" }
    )]
    Tripped {
        /// The motion.
        motion: String,
        /// Why.
        trip: StageTrip,
    },
    /// A stated value is far off.
    #[error(
        "{name} is {have:.4} by {motion}, and {stated} is stated: off by a factor of {factor:.2}, and {WRONG} is the limit; {}",
        checked.remedy()
    )]
    Wrong {
        /// The motion.
        motion: String,
        /// What is off.
        checked: Checked,
        /// Name of the parameter with its unit.
        name: &'static str,
        /// The estimate.
        have: f64,
        /// The stated value.
        stated: f64,
        /// Larger over smaller.
        factor: f64,
    },
    /// The motions don't show a value.
    #[error(
        "{name} is {shown} after all motions, and {limit} % is the widest interval; raise the torque limit, or free the motor to \
         turn for the torque constant"
    )]
    NotShown {
        /// Name of the parameter.
        name: &'static str,
        /// How well it is known.
        shown: String,
        /// Widest half of its interval in %.
        limit: f64,
    },
    /// The motor doesn't come to rest.
    #[error(
        "{motion}: the drive train moves without torque, {ATTEMPTS} times in a row; wait until it is at rest"
    )]
    NotAtRest {
        /// The motion.
        motion: String,
    },
}

/// Makes the motions and estimates the motor. The sensor's direction shows in an open loop of a small voltage; its scale and that of
/// the voltage show before larger currents.
///
/// # Errors
/// See [`ElectricalError`].
pub fn commission_motor<T: ElectricalTrain>(
    train: &mut T,
    instruments: &Instruments,
    limits: &Limits,
    period_us: u32,
    stated: &Stated,
) -> Result<Motor, ElectricalError<T::Error>> {
    let Limits { torque_nm, motor_speed_rad_s, load_speed_rad_s, load_travel_rad } = *limits;
    let limits = Limits {
        torque_nm,
        motor_speed_rad_s: MARGIN * motor_speed_rad_s,
        load_speed_rad_s: MARGIN * load_speed_rad_s,
        load_travel_rad: MARGIN * load_travel_rad,
    };
    let period_s = f64::from(period_us) / 1e6;
    let count_rad = 1.0 / instruments.motor_counts_per_rad();
    let mut bench =
        Bench { train, instruments, limits, period_s, stated: *stated, origin: None, load_moved_rad: 0.0 };
    bench.polarity()?;
    let hold_s = HOLD_S.max(HOLD_TIME_CONSTANTS * stated.inductance_h / stated.resistance_ohm);
    let (mut motions, mut shown) = (Vec::new(), Motor::default());
    // Holds that are too short for the motor to turn far, then longer ones.
    for (kind, hold_s) in [("electrical-steps", hold_s), ("electrical-spin", hold_s.max(SPIN_HOLD_S))] {
        for (at, part) in CLOSED.into_iter().enumerate() {
            let name = format!("{kind}-{}", at + 1);
            let rounds = if kind == "electrical-spin" { 1 } else { ROUNDS };
            let motion = motions::groups(name.clone(), part * stated.largest_a, hold_s, rounds, period_s);
            let made = bench.hold(&motion)?;
            motions.push(made.steps);
            shown = motor(&motions, count_rad, stated);
            shown.load_moved_rad = bench.load_moved_rad;
            check(&shown, stated, &name)?;
            if is_within(&shown, NARROW) {
                return Ok(shown);
            }
            if made.halt.is_some() {
                break;
            }
        }
    }
    widest(&shown)?;
    Ok(shown)
}

struct Bench<'a, T> {
    train: &'a mut T,
    instruments: &'a Instruments,
    limits: Limits,
    period_s: f64,
    stated: Stated,
    /// Load counts at the first sample of all.
    origin: Option<i64>,
    /// Distance of the load from there.
    load_moved_rad: f64,
}

impl<T: ElectricalTrain> Bench<'_, T> {
    fn hold(&mut self, motion: &HeldCurrents) -> Result<MadeSteps, ElectricalError<T::Error>> {
        let guard = Guard::new(self.limits, self.instruments, self.period_s, self.origin, None);
        // A reversed sensor moves the motor from the first step on.
        let guard = if motion.largest_v.is_some() { guard.without_rest() } else { guard };
        let name = || motion.name.clone();
        for _ in 0..ATTEMPTS {
            let Some(made) = self.train.hold(motion, guard.clone()).map_err(ElectricalError::Motion)? else {
                continue;
            };
            let [first, last] = made.load_counts;
            let origin = *self.origin.get_or_insert(first);
            self.load_moved_rad = (last - origin).abs() as f64 / self.instruments.load_counts_per_rad();
            return match made.trip {
                Some(trip) => Err(ElectricalError::Tripped { motion: name(), trip }),
                None => Ok(made),
            };
        }
        Err(ElectricalError::NotAtRest { motion: name() })
    }

    /// The open loop.
    fn polarity(&mut self) -> Result<(), ElectricalError<T::Error>> {
        let Stated { resistance_ohm, inductance_h, torque_constant_nm_a, largest_a, .. } = self.stated;
        for (at, part) in OPEN.into_iter().enumerate() {
            let hold_s = OPEN_HOLD_S.max(OPEN_TIME_CONSTANTS * inductance_h / resistance_ohm);
            let motion = motions::polarity(at + 1, part * largest_a, resistance_ohm, hold_s, self.period_s);
            let held = self.hold(&motion)?.steps.held(inductance_h, torque_constant_nm_a);
            let (voltage_v, current_a) = (held.voltage_v(), held.current_a());
            let expected_a = voltage_v / resistance_ohm;
            let motion = motion.name;
            if current_a.abs() >= SHOWN * expected_a && current_a != 0.0 {
                if current_a < 0.0 {
                    return Err(ElectricalError::SensorReversed { motion, voltage_v, current_a });
                }
                // Dead time and brushes leave the size open.
                return Ok(());
            }
            if at + 1 == OPEN.len() {
                return Err(ElectricalError::NoCurrent { motion, voltage_v, current_a, expected_a });
            }
        }
        Ok(())
    }
}

fn compare<E>(checked: Checked, have: f64, stated: f64, motion: &str) -> Result<(), ElectricalError<E>> {
    let factor = (have / stated).max(stated / have);
    if have > 0.0 && factor <= WRONG {
        return Ok(());
    }
    let name = match checked {
        Checked::Resistance => "motor_resistance_ohm",
        Checked::TorqueConstant => "torque_constant_nm_a",
    };
    Err(ElectricalError::Wrong { motion: motion.to_owned(), checked, name, have, stated, factor })
}

/// Compares what is known well with what is stated.
fn check<E>(shown: &Motor, stated: &Stated, motion: &str) -> Result<(), ElectricalError<E>> {
    let [resistance, _, constant] = [WIDEST[0], WIDEST[1], WIDEST[2]];
    for (checked, estimate, stated, widest) in [
        (Checked::TorqueConstant, shown.torque_constant_nm_a, stated.torque_constant_nm_a, constant),
        (Checked::Resistance, shown.resistance_ohm, stated.resistance_ohm, resistance),
    ] {
        if let Some(it) = estimate.filter(|it| width(it) <= widest) {
            compare(checked, it.value, stated, motion)?;
        }
    }
    Ok(())
}

/// Half the width of an interval as a part of its value.
fn width(estimate: &Estimate) -> f64 {
    half_width(estimate) / estimate.value.abs()
}

fn all_three(shown: &Motor) -> [(&'static str, Option<Estimate>); 3] {
    [
        ("motor_resistance_ohm", shown.resistance_ohm),
        ("motor_inductance_h", shown.inductance_h),
        ("torque_constant_nm_a", shown.torque_constant_nm_a),
    ]
}

fn is_within(shown: &Motor, widths: [f64; 3]) -> bool {
    let mut pairs = all_three(shown).into_iter().zip(widths);
    pairs.all(|((_, estimate), limit)| estimate.is_some_and(|it| it.value > 0.0 && width(&it) <= limit))
}

fn widest<E>(shown: &Motor) -> Result<(), ElectricalError<E>> {
    for ((name, estimate), limit) in all_three(shown).into_iter().zip(WIDEST) {
        let problem = match estimate {
            Some(it) if it.value > 0.0 && width(&it) <= limit => continue,
            Some(it) => format!("known to {:.0} %", 100.0 * width(&it)),
            None => "not shown".to_owned(),
        };
        return Err(ElectricalError::NotShown { name, shown: problem, limit: 100.0 * limit });
    }
    Ok(())
}
