//! The balance of the flux between the ends of holds, by linear least squares.

use nalgebra::{DMatrix, DVector};

use super::stated::Stated;
use crate::quantity::{Estimate, Quantity};

/// Standard deviations on each side of an interval of 95 %: the quantisation of the encoder isn't normally distributed.
const DEVIATIONS: f64 = 2.5;
/// Windows in a row that count as one sample of the scatter: an error of an angle is in two of them.
const CLUSTER: usize = 4;
/// Part of an estimate that the instruments leave open: flat ends of holds, and the step of the duty.
const SYSTEMATIC: f64 = 0.003;
/// Currents above which the dead time takes its whole voltage, as parts of the largest: the ripple sets it, and the best fit counts.
const DEAD_TIME_FROM: [f64; 8] = [0.01, 0.02, 0.04, 0.07, 0.11, 0.17, 0.25, 0.35];
/// Root mean square of the angles, in counts, from which they show the back-EMF: below, the quantisation attenuates it.
const SHOWN_COUNTS: f64 = 10.0;
/// Shortest hold in steps whose end is flat.
const SHORTEST: usize = 3;
/// Least current at both ends of a window, as a part of the largest.
const LEAST: f64 = 0.1;
/// Time between a step and the middle between two pulses, in periods of the modulation: half, and a little for the interrupt.
const LATE: f64 = 0.6;
/// Fewest windows of a fit.
const FEWEST: usize = 24;

/// A motion, step by step. A step without telemetry has NaN.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Steps {
    /// Control period in s.
    pub period_s: f64,
    /// Commanded current from this step on, in A.
    pub commanded_a: Vec<f64>,
    /// Mean current since the step before, in A.
    pub current_a: Vec<f64>,
    /// Mean voltage of the bridge since the step before, in V.
    pub voltage_v: Vec<f64>,
    /// Position of the motor at the step, in rad.
    pub motor_rad: Vec<f64>,
}

/// Flux between the ends of two holds, in V s, and its causes.
struct Window {
    flux_vs: f64,
    causes: [f64; COUNT],
    /// Change of the speed in rad/s.
    faster_rad_s: f64,
}

const COUNT: usize = 5;
/// Places of the causes.
const RESISTANCE: usize = 0;
const INDUCTANCE: usize = 1;
const BACK_EMF: usize = 2;
const DEAD_TIME: usize = 3;
const OFFSET: usize = 4;

/// What the motions show of a motor. `None` is what they don't show.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motor {
    /// Resistance with that of the bridge, in Ohm.
    pub resistance_ohm: Option<Estimate>,
    /// Inductance in H.
    pub inductance_h: Option<Estimate>,
    /// Constant of the back-EMF in V s/rad, without its sign; the torque constant in N m/A is equal.
    pub torque_constant_nm_a: Option<Estimate>,
    /// Voltage that the dead time takes, in V.
    pub dead_voltage_v: Option<Estimate>,
    /// What the sensor shows at no current, with the bridge on, in A.
    pub current_offset_a: Option<Estimate>,
    /// Whether the encoder counts down while a positive current turns the motor.
    pub is_encoder_reversed: bool,
    /// Distance in rad of the load from where it stood before the first motion.
    pub load_moved_rad: f64,
}

impl Motor {
    /// The quantities, with the drive's names of them.
    #[must_use]
    pub fn quantities(&self) -> [Quantity; COUNT] {
        let quantity = |name, unit, meaning, estimate, drive_parameter| Quantity {
            name,
            unit,
            meaning,
            estimate,
            plant_key: None,
            drive_parameter,
        };
        let parameter = |name, unit, meaning, estimate| quantity(name, unit, meaning, estimate, Some(name));
        [
            parameter("motor_resistance_ohm", "Ohm", "R of armature and bridge", self.resistance_ohm),
            parameter("motor_inductance_h", "H", "L of the armature", self.inductance_h),
            parameter("torque_constant_nm_a", "N m/A", "k_t, by k_e in V s/rad", self.torque_constant_nm_a),
            quantity("dead_voltage_v", "V", "taken by the dead time", self.dead_voltage_v, None),
            quantity("current_offset_a", "A", "shown at no current", self.current_offset_a, None),
        ]
    }
}

impl Steps {
    /// Steps at which a hold ends.
    fn ends(&self) -> Vec<usize> {
        let mut ends = Vec::new();
        let mut begun = 0;
        for at in 1..self.commanded_a.len() {
            if self.commanded_a[at] != self.commanded_a[at - 1] {
                if at - begun >= SHORTEST {
                    ends.push(at);
                }
                begun = at;
            }
        }
        ends
    }

    /// Current at the end of a hold: the last mean, and half of its last change.
    fn flat_a(&self, end: usize) -> f64 {
        let [before, last] = [self.current_a[end - 1], self.current_a[end]];
        last + 0.5 * (last - before)
    }

    /// Speed at a step, from the angles around it.
    fn speed_rad_s(&self, at: usize) -> f64 {
        let next = if self.motor_rad.get(at + 1).is_some_and(|it| it.is_finite()) { at + 1 } else { at };
        (self.motor_rad[next] - self.motor_rad[at - 1]) / ((next + 1 - at) as f64 * self.period_s)
    }

    fn largest_a(&self) -> f64 {
        self.current_a.iter().fold(0.0, |largest, it| largest.max(it.abs()))
    }

    fn windows(&self, soft_a: f64) -> Vec<Window> {
        let (ends, least_a) = (self.ends(), LEAST * self.largest_a());
        let window = |pair: &[usize]| {
            let (from, to) = (pair[0], pair[1]);
            let sum = |of: &[f64], shape: &dyn Fn(f64) -> f64| {
                self.period_s * of[from + 1..=to].iter().map(|it| shape(*it)).sum::<f64>()
            };
            Window {
                flux_vs: sum(&self.voltage_v, &|it| it),
                causes: [
                    sum(&self.current_a, &|it| it),
                    self.flat_a(to) - self.flat_a(from),
                    self.motor_rad[to] - self.motor_rad[from],
                    sum(&self.current_a, &|it| (it / soft_a).clamp(-1.0, 1.0)),
                    self.period_s * (to - from) as f64,
                ],
                faster_rad_s: self.speed_rad_s(to) - self.speed_rad_s(from),
            }
        };
        // Of a current that changes its sign nothing shows when the dead time takes which voltage.
        let keeps_sign = |pair: &&[usize]| self.flat_a(pair[0]) * self.flat_a(pair[1]) > least_a.powi(2);
        let is_whole = |it: &Window| it.flux_vs.is_finite() && it.causes.iter().all(|it| it.is_finite());
        ends.windows(2).filter(keeps_sign).map(window).filter(is_whole).collect()
    }

    /// Flux that is left to the resistance, and charge, along the voltage of each hold.
    pub(super) fn held(&self, inductance_h: f64, back_emf_vs: f64) -> Held {
        let (mut held, mut begun) = (Held::default(), 0);
        for end in self.ends() {
            let from = std::mem::replace(&mut begun, end);
            if self.commanded_a[from] == 0.0 {
                continue;
            }
            let sum = |of: &[f64]| self.period_s * of[from + 1..=end].iter().sum::<f64>();
            // With a reversed sensor the voltage may have either sign.
            let sign = sum(&self.voltage_v).signum();
            // Neither the direction of the encoder nor that of the sensor is known yet.
            let turned_vs = back_emf_vs * (self.motor_rad[end] - self.motor_rad[from]).abs();
            let flux_vs = sign * sum(&self.voltage_v) - turned_vs - inductance_h * self.flat_a(end).abs();
            let charge_as = sign * sum(&self.current_a);
            if flux_vs.is_finite() && charge_as.is_finite() {
                held.flux_vs += flux_vs;
                held.charge_as += charge_as;
                held.time_s += self.period_s * (end - from) as f64;
            }
        }
        held
    }
}

/// Sums over held currents.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Held {
    flux_vs: f64,
    charge_as: f64,
    time_s: f64,
}

impl Held {
    /// Mean voltage at the resistance in V.
    pub(super) fn voltage_v(&self) -> f64 {
        self.flux_vs / self.time_s.max(f64::MIN_POSITIVE)
    }

    /// Mean current along the voltage in A.
    pub(super) fn current_a(&self) -> f64 {
        self.charge_as / self.time_s.max(f64::MIN_POSITIVE)
    }
}

/// Estimates the motor from these motions. `count_rad` is a count of its encoder; angles that are too small to show the back-EMF
/// count with the `stated` constant. A period of the modulation may lie anywhere to a step, so the angles may be early or late by a
/// part of `pulse_s`.
pub(super) fn motor(motions: &[Steps], count_rad: f64, stated: &Stated) -> Motor {
    let largest_a = motions.iter().map(Steps::largest_a).fold(f64::MIN_POSITIVE, f64::max);
    let fits = DEAD_TIME_FROM.into_iter().filter_map(|part| {
        let windows: Vec<_> = motions.iter().map(|it| it.windows(part * largest_a)).collect();
        fit(&windows, count_rad, stated)
    });
    let best = fits.min_by(|left, right| left.0.total_cmp(&right.0));
    best.map_or_else(Motor::default, |(_, motor)| motor)
}

/// The sum of the squares of the residuals, and the motor; `None` if the windows don't show it.
fn fit(windows: &[Vec<Window>], count_rad: f64, stated: &Stated) -> Option<(f64, Motor)> {
    let all = || windows.iter().flatten();
    let number = all().count();
    if number < FEWEST {
        return None;
    }
    let root_mean_square = |cause: usize| {
        (all().map(|it| it.causes[cause] * it.causes[cause]).sum::<f64>() / number as f64).sqrt()
    };
    let scales: [f64; COUNT] = std::array::from_fn(root_mean_square);
    let turns = scales[BACK_EMF] >= SHOWN_COUNTS * count_rad;
    let used: Vec<usize> = (0..COUNT).filter(|at| scales[*at] > 0.0 && (*at != BACK_EMF || turns)).collect();
    let row =
        |it: &Window| DVector::from_iterator(used.len(), used.iter().map(|at| it.causes[*at] / scales[*at]));
    let known_vs = |it: &Window| {
        it.flux_vs - if turns { 0.0 } else { stated.torque_constant_nm_a * it.causes[BACK_EMF] }
    };
    let (mut matrix, mut right) = (DMatrix::zeros(used.len(), used.len()), DVector::zeros(used.len()));
    let mut late = DVector::zeros(used.len());
    for window in all() {
        let row = row(window);
        matrix += &row * row.transpose();
        right += &row * known_vs(window);
        late += &row * (stated.torque_constant_nm_a * LATE * stated.pulse_s * window.faster_rad_s);
    }
    let inverse = matrix.cholesky()?.inverse();
    let (values, late) = (&inverse * right, &inverse * late);
    let (mut scatter, mut clusters, mut squares) = (DMatrix::zeros(used.len(), used.len()), 0.0_f64, 0.0);
    for cluster in windows.iter().flat_map(|it| it.chunks(CLUSTER)) {
        let mut sum = DVector::zeros(used.len());
        for window in cluster {
            let row = row(window);
            let residual_vs = known_vs(window) - row.dot(&values);
            squares += residual_vs * residual_vs;
            sum += &row * residual_vs;
        }
        scatter += &sum * sum.transpose();
        clusters += 1.0;
    }
    let free = number as f64 / (number - used.len()) as f64 * clusters / (clusters - 1.0);
    let covariance = &inverse * scatter * &inverse * free;
    let estimate = |cause: usize| {
        let at = used.iter().position(|it| *it == cause)?;
        let value = values[at] / scales[cause];
        let scattered = DEVIATIONS * covariance[(at, at)].max(0.0).sqrt();
        let half = (scattered + late[at].abs()) / scales[cause] + SYSTEMATIC * value.abs();
        Some(around(value, half)).filter(|it| it.value.is_finite() && half.is_finite())
    };
    let back_emf = estimate(BACK_EMF);
    let resistance_ohm = estimate(RESISTANCE);
    let motor = Motor {
        resistance_ohm,
        inductance_h: estimate(INDUCTANCE),
        torque_constant_nm_a: back_emf.map(|it| around(it.value.abs(), half_width(&it))),
        dead_voltage_v: estimate(DEAD_TIME),
        // v_0 is - R times the offset.
        current_offset_a: estimate(OFFSET).zip(resistance_ohm).map(|(offset, resistance)| {
            around(-offset.value / resistance.value, half_width(&offset) / resistance.value.abs())
        }),
        is_encoder_reversed: back_emf.is_some_and(|it| it.value < 0.0),
        load_moved_rad: 0.0,
    };
    Some((squares, motor))
}

fn around(value: f64, half: f64) -> Estimate {
    Estimate { value, low: value - half, high: value + half }
}

/// Half the width of an interval.
pub(super) fn half_width(estimate: &Estimate) -> f64 {
    0.5 * (estimate.high - estimate.low)
}
