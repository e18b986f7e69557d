//! Load velocity from its quantised position and the transmitted torque.
//!
//! One count of the load encoder within a millisecond is a velocity of more than 1 rad/s at 4000 counts: a velocity
//! loop can't use a differenced position. The observer models the load by its position, its velocity om and a
//! disturbing torque d:
//!
//! ```text
//! d(theta)/dt = om + l1 e                               e = theta_s - theta
//! d(om)/dt    = (N0 C_obs - f_s om - d) / J_s + l2 e
//! d(d)/dt     = l3 e
//! ```
//!
//! and a triple pole at -p: l1 = 3 p - f_s/J_s, l2 = 3 p^2 - l1 f_s/J_s, l3 = -J_s p^3. Euler's rule moves a pole s of
//! it to 1 + s T. The state holds the error e instead of the position: far from zero a single-precision position has no
//! digits for the motion within one period, but the difference of two positions has.

use crate::control::nominal_model::NominalModel;
use crate::law::Real;

/// The observer with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct LoadObserver<F> {
    ratio: F,
    friction_nm_s_rad: F,
    per_inertia: F,
    period_s: F,
    position_gain: F,
    velocity_gain: F,
    disturbance_gain: F,
}

/// State of the observer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct LoadObserverState<F> {
    position_rad: F,
    /// Measured minus observed position in rad.
    error_rad: F,
    velocity_rad_s: F,
    disturbance_nm: F,
}

/// The load as observed at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct ObservedLoad<F> {
    /// Load velocity in rad/s.
    pub(in crate::control) velocity_rad_s: F,
    /// Torque against a positive motion in N m at the load: dry friction and load torque.
    pub(in crate::control) disturbance_nm: F,
    /// Transmitted torque at the motor in N m.
    pub(in crate::control) transmitted_nm: F,
    /// Measured minus observed position in rad.
    pub(in crate::control) position_error_rad: F,
}

impl<F: Real> LoadObserverState<F> {
    /// The load after the last sample, which came with this transmitted torque.
    pub(in crate::control) fn observed(&self, transmitted_nm: F) -> ObservedLoad<F> {
        ObservedLoad {
            velocity_rad_s: self.velocity_rad_s,
            disturbance_nm: self.disturbance_nm,
            transmitted_nm,
            position_error_rad: self.error_rad,
        }
    }
}

impl<F: Real> LoadObserver<F> {
    /// An observer of the load of `model` with its poles at `-pole_rad_s`.
    pub(in crate::control) fn new(model: &NominalModel<F>, pole_rad_s: F, period_s: F) -> Self {
        let (three, pole) = (F::from_f64(3.0), pole_rad_s);
        let decay = model.load_friction_nm_s_rad / model.load_inertia_kg_m2;
        let position_gain = three * pole - decay;
        Self {
            ratio: model.reduction_ratio,
            friction_nm_s_rad: model.load_friction_nm_s_rad,
            per_inertia: F::ONE / model.load_inertia_kg_m2,
            period_s,
            position_gain,
            velocity_gain: three * pole * pole - position_gain * decay,
            disturbance_gain: -(model.load_inertia_kg_m2 * pole * pole * pole),
        }
    }

    /// The state for a load at rest.
    pub(in crate::control) fn initial_state(position_rad: F) -> LoadObserverState<F> {
        LoadObserverState {
            position_rad,
            error_rad: F::ZERO,
            velocity_rad_s: F::ZERO,
            disturbance_nm: F::ZERO,
        }
    }

    /// Load velocity in rad/s after this sample.
    // Two laws step it: out of line, the call costs each of them some ten instructions.
    #[inline(always)]
    pub(in crate::control) fn step(
        &self,
        state: &mut LoadObserverState<F>,
        position_rad: F,
        transmitted_nm: F,
    ) -> F {
        let error = state.error_rad + (position_rad - state.position_rad);
        let velocity = state.velocity_rad_s;
        let driving_nm =
            self.ratio * transmitted_nm - self.friction_nm_s_rad * velocity - state.disturbance_nm;
        state.position_rad = position_rad;
        state.error_rad = error - self.period_s * (velocity + self.position_gain * error);
        state.velocity_rad_s += self.period_s * (driving_nm * self.per_inertia + self.velocity_gain * error);
        state.disturbance_nm += self.period_s * self.disturbance_gain * error;
        state.velocity_rad_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 1e-3;

    fn observer<F: Real>() -> LoadObserver<F> {
        LoadObserver::new(&NominalModel::default(), F::from_f64(12.0), F::from_f64(PERIOD_S))
    }

    #[test]
    fn steady_motion_against_unknown_friction_has_no_error() {
        let observer = observer::<f64>();
        let mut state = LoadObserver::initial_state(1.5);
        // 0.5 rad/s against 16 N m s/rad and 3.4 N m of friction outside the model.
        let transmitted_nm = (16.0 * 0.5 + 3.4) / 3.0;
        let mut velocity = 0.0;
        for k in 0..3000 {
            velocity = observer.step(&mut state, 1.5 + 0.5 * PERIOD_S * f64::from(k), transmitted_nm);
        }
        assert!((velocity - 0.5).abs() < 1e-9, "have {velocity} rad/s");
        assert!((state.disturbance_nm - 3.4).abs() < 1e-7, "have {} N m", state.disturbance_nm);
    }

    #[test]
    fn observer_error_decays_with_the_triple_pole() {
        let observer = observer::<f64>();
        let mut state = LoadObserver::initial_state(0.0);
        state.error_rad = 0.01;
        let mut errors = std::vec::Vec::new();
        for _ in 0..2000 {
            observer.step(&mut state, 0.0, 0.0);
            errors.push(state.error_rad);
        }
        // e^(-p t) times a parabola: after 2 s the ratio of successive errors has come down to 1 - p T.
        let ratio = errors[1999] / errors[1998];
        assert!((ratio - (1.0 - 12.0 * PERIOD_S)).abs() < 2e-3, "have {ratio}");
        assert!(errors[1999].abs() < 1e-9, "have {}", errors[1999]);
    }

    #[test]
    fn quantisation_of_a_slow_load_ripples_the_velocity_little() {
        let observer = observer::<f64>();
        let lsb = core::f64::consts::TAU / 4000.0;
        let mut state = LoadObserver::initial_state(0.0);
        let (mut lowest, mut highest) = (f64::MAX, f64::MIN);
        for k in 0..8000 {
            let position = ((0.05 * PERIOD_S * f64::from(k)) / lsb).floor() * lsb;
            let velocity = observer.step(&mut state, position, 16.0 * 0.05 / 3.0);
            if k > 4000 {
                (lowest, highest) = (lowest.min(velocity), highest.max(velocity));
            }
        }
        // One count per millisecond would be 1.57 rad/s.
        assert!(lowest > 0.03 && highest < 0.07, "0.05 rad/s are observed as {lowest} to {highest} rad/s");
    }

    #[test]
    fn single_precision_holds_a_hundred_turns_from_zero() {
        let observer = observer::<f32>();
        let begin = 628.0_f32;
        let mut state = LoadObserver::initial_state(begin);
        let mut velocity = 0.0;
        for k in 0..3000 {
            velocity = observer.step(&mut state, begin + 0.5e-3 * k as f32, 8.0 / 3.0);
        }
        // A position of 628 rad is rounded to 6e-5 rad.
        assert!((velocity - 0.5).abs() < 2e-3, "have {velocity} rad/s");
    }
}
