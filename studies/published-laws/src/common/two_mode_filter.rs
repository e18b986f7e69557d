//! A Kalman filter of the drive with two modes, contact and gap.
//!
//! After A. Lagerberg, B. Egardt, "Backlash estimation with application to automotive powertrains", IEEE Transactions on
//! Control Systems Technology 15 (2007) 483-493: an extended Kalman filter whose model switches between contact and gap, with
//! the size of the gap as a state. Restated from the idea, with these deviations:
//!
//! - One filter has the mechanics and the size; the paper has one estimator for each.
//! - Samples come at a fixed rate; those of the paper come with each pulse of a sensor.
//! - The mode follows the torque that the motor observes, not the estimated twist. A gap that is overestimated would
//!   otherwise hide contact forever.
//! - The stiffness and a disturbing torque of the load are states, because plants differ by 30 % and have dry friction.
//!
//! ```text
//! C = K (z - s j) in contact on side s, 0 in the gap,   z = theta_e - N0 theta_s
//! J_s d(om_s)/dt = N0 C - f_s om_s - d,   J_m d(om_e)/dt = U - C - f_m om_e,   K, j, d: random walks
//! ```

use core::f32::consts::TAU;

use lashloop_firmware::control::momentum_observer::MomentumObserver;
use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::law::{DriveParameters, Measurement};
use nalgebra::{SMatrix, SVector};

/// Pole of the observed torque, and torque from which the flanks touch.
const CONTACT_POLE_RAD_S: f32 = 100.0;
const CONTACT_NM: f32 = 0.25;
/// Standard deviations at the start: positions (rad), velocities (rad/s), disturbing torque (over the torque limit at the
/// load), half gap (rad).
const START: [f32; 6] = [1e-3, 1e-3, 1e-3, 1e-3, 0.05, 0.15];
/// Standard deviation of the stiffness at the start, as a fraction.
const STIFFNESS_DEVIATION: f32 = 0.3;
/// Largest half gap (rad), and range of the stiffness as fractions of the nominal one.
const LARGEST_GAP_RAD: f32 = 0.8;
const STIFFNESS_RANGE: [f32; 2] = [0.5, 2.0];
/// Variance of a count in counts: uniform within a count.
const COUNT_VARIANCE: f32 = 1.0 / 12.0;

lashloop_firmware::parameters! {
    /// Process noise of the filter: what the model does not contain.
    pub struct FilterNoise {
        /// Torque against the load, random walk.
        noise_disturbance_nm: F32 = 30.0 in 1e-6..=1e6, "N m/s^0.5";
        /// Torque at the motor, white.
        noise_motor_nm: F32 = 0.02 in 1e-6..=1e6, "N m s^0.5";
        /// Half gap, random walk.
        noise_gap_rad: F32 = 0.003 in 0.0..=1e3, "rad/s^0.5";
    }
}

const STATES: usize = 7;
type Vector = SVector<f32, STATES>;
type Covariance = SMatrix<f32, STATES, STATES>;
// Indices of the states.
const THETA_S: usize = 0;
const OM_S: usize = 1;
const THETA_E: usize = 2;
const OM_E: usize = 3;
const D: usize = 4;
const J: usize = 5;
const K: usize = 6;

/// The drive at one sample, as estimated.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Estimate {
    pub(crate) load_error_rad: f32,
    pub(crate) load_velocity_rad_s: f32,
    pub(crate) motor_velocity_rad_s: f32,
    pub(crate) twist_rad: f32,
    /// Torque against the load (N m at the load).
    pub(crate) disturbance_nm: f32,
    pub(crate) dead_zone_rad: f32,
    pub(crate) stiffness_nm_rad: f32,
}

/// The filter with its constants and its state.
#[derive(Debug, Clone)]
pub(crate) struct TwoModeFilter {
    model: NominalModel,
    process_variance: Vector,
    /// Of motor and load position.
    measurement_variance: [f32; 2],
    period_s: f32,
    observer: MomentumObserver<f32>,
    momentum_balance_nm: f32,
    /// Positions are relative to those of the last sample: far from zero a single-precision position has no digits for the
    /// motion within a period.
    state: Vector,
    covariance: Covariance,
    last: Option<Measurement<f32>>,
}

impl TwoModeFilter {
    pub(crate) fn new(noise: FilterNoise, model: NominalModel, drive: &DriveParameters) -> Self {
        let period_s = drive.period_s();
        let [d, u, j] = [noise.noise_disturbance_nm, noise.noise_motor_nm, noise.noise_gap_rad];
        let acceleration = u / model.motor_inertia_kg_m2;
        let count_variance = |counts: u32| {
            let count_rad = TAU / counts as f32;
            COUNT_VARIANCE * count_rad * count_rad
        };
        let mut deviation = Vector::zeros();
        deviation.fixed_rows_mut::<6>(0).copy_from_slice(&START);
        deviation[D] *= model.reduction_ratio * drive.torque_limit_nm;
        deviation[K] = STIFFNESS_DEVIATION * model.stiffness_nm_rad;
        let mut state = Vector::zeros();
        state[J] = model.dead_zone_rad;
        state[K] = model.stiffness_nm_rad;
        Self {
            model,
            process_variance: Vector::from([0.0, 0.0, 0.0, acceleration * acceleration, d * d, j * j, 0.0])
                * period_s,
            measurement_variance: [
                count_variance(drive.motor_counts_per_rev),
                count_variance(drive.load_counts_per_rev),
            ],
            period_s,
            observer: MomentumObserver::new(&model, CONTACT_POLE_RAD_S, period_s),
            momentum_balance_nm: 0.0,
            state,
            covariance: Covariance::from_diagonal(&deviation.component_mul(&deviation)),
            last: None,
        }
    }

    /// Predicts over the period before this sample and corrects by both positions.
    pub(crate) fn step(&mut self, m: &Measurement<f32>) -> Estimate {
        let last = self.last.replace(*m).unwrap_or(*m);
        let observed_nm = self.observer.step(&mut self.momentum_balance_nm, m);
        let contact = observed_nm.abs() > CONTACT_NM;
        // The motor's torque is late by a period.
        self.predict(last.applied_torque_nm, last.twist_rad, contact.then(|| 1.0_f32.copysign(observed_nm)));
        let load_rad = m.load_position_rad - last.load_position_rad;
        let motor_rad = (m.twist_rad - last.twist_rad) + self.model.reduction_ratio * load_rad;
        self.correct(THETA_E, motor_rad, self.measurement_variance[0]);
        self.correct(THETA_S, load_rad, self.measurement_variance[1]);
        self.covariance = (self.covariance + self.covariance.transpose()) * 0.5;
        self.state[THETA_S] -= load_rad;
        self.state[THETA_E] -= motor_rad;
        self.state[J] = self.state[J].clamp(0.0, LARGEST_GAP_RAD);
        let [low, high] = STIFFNESS_RANGE.map(|fraction| fraction * self.model.stiffness_nm_rad);
        self.state[K] = self.state[K].clamp(low, high);
        let x = &self.state;
        Estimate {
            load_error_rad: m.load_position_rad - m.reference_position_rad + x[THETA_S],
            load_velocity_rad_s: x[OM_S],
            motor_velocity_rad_s: x[OM_E],
            twist_rad: m.twist_rad + x[THETA_E] - self.model.reduction_ratio * x[THETA_S],
            disturbance_nm: x[D],
            dead_zone_rad: x[J],
            stiffness_nm_rad: x[K],
        }
    }

    /// `side`: that of the contact; `None` in the gap.
    fn predict(&mut self, torque_nm: f32, measured_twist_rad: f32, side: Option<f32>) {
        let NominalModel { motor_inertia_kg_m2, load_inertia_kg_m2, reduction_ratio: ratio, .. } = self.model;
        let [per_motor, per_load] = [self.period_s / motor_inertia_kg_m2, self.period_s / load_inertia_kg_m2];
        let x = &self.state;
        let (mut transmitted_nm, mut slope) = (0.0, Vector::zeros());
        if let Some(side) = side {
            let wound_rad = measured_twist_rad + x[THETA_E] - ratio * x[THETA_S] - side * x[J];
            transmitted_nm = x[K] * wound_rad;
            slope[THETA_S] = -ratio * x[K];
            slope[THETA_E] = x[K];
            slope[J] = -side * x[K];
            slope[K] = wound_rad;
        }
        let mut transition = Covariance::identity();
        transition[(THETA_S, OM_S)] = self.period_s;
        transition[(THETA_E, OM_E)] = self.period_s;
        for (column, &slope) in slope.iter().enumerate() {
            transition[(OM_S, column)] += per_load * ratio * slope;
            transition[(OM_E, column)] -= per_motor * slope;
        }
        transition[(OM_S, OM_S)] -= per_load * self.model.load_friction_nm_s_rad;
        transition[(OM_S, D)] -= per_load;
        transition[(OM_E, OM_E)] -= per_motor * self.model.motor_friction_nm_s_rad;
        self.covariance = transition * self.covariance * transition.transpose();
        for (state, variance) in self.process_variance.iter().enumerate() {
            self.covariance[(state, state)] += variance;
        }
        let (load, motor) = (x[OM_S], x[OM_E]);
        let load_nm = ratio * transmitted_nm - self.model.load_friction_nm_s_rad * load - x[D];
        let motor_nm = torque_nm - transmitted_nm - self.model.motor_friction_nm_s_rad * motor;
        self.state[THETA_S] += self.period_s * load;
        self.state[THETA_E] += self.period_s * motor;
        self.state[OM_S] += per_load * load_nm;
        self.state[OM_E] += per_motor * motor_nm;
    }

    fn correct(&mut self, measured: usize, value: f32, variance: f32) {
        let spread: Vector = self.covariance.column(measured).into();
        let gain = spread / (spread[measured] + variance);
        self.state += gain * (value - self.state[measured]);
        self.covariance -= gain * spread.transpose();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motor that winds and unwinds a shaft with a half gap of 0.3 rad against a load that stands.
    #[test]
    fn gap_and_stiffness_are_found_from_a_standing_load() {
        let model = NominalModel { load_inertia_kg_m2: 1e4, ..NominalModel::default() };
        let (gap_rad, stiffness_nm_rad) = (0.3, 1.2);
        let mut filter = TwoModeFilter::new(FilterNoise::default(), model, &DriveParameters::default());
        let (mut position, mut velocity) = (0.0_f32, 0.0_f32);
        let mut last = Estimate::default();
        for k in 0..20_000 {
            let wanted = 2.5 * libm_sine(k as f32 * 2e-3);
            let torque = wanted + 0.3 * (wanted - position) - 0.05 * velocity;
            for _ in 0..10 {
                let transmitted = stiffness_nm_rad * (position - position.clamp(-gap_rad, gap_rad));
                velocity += 1e-4 * (torque - transmitted - 4.3e-4 * velocity) / 9.72e-4;
                position += 1e-4 * velocity;
            }
            last = filter.step(&Measurement {
                motor_position_rad: position,
                motor_velocity_rad_s: velocity,
                twist_rad: position,
                applied_torque_nm: torque,
                ..Measurement::default()
            });
        }
        assert!((last.dead_zone_rad - gap_rad).abs() < 0.03, "{last:?}");
        assert!((last.stiffness_nm_rad - stiffness_nm_rad).abs() < 0.06, "{last:?}");
    }

    fn libm_sine(angle: f32) -> f32 {
        f64::from(angle).sin() as f32
    }
}
