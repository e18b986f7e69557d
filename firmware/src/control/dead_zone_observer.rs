//! The estimate of the dead-zone amplitude, equation (19).
//!
//! d(j_hat)/dt = (k21 e_s + k22 e_zeta) sign(z). The paper prints the other sign: it states the law for the side z < 0,
//! from which it approaches, and extends it by symmetry. The estimate is clamped from zero to an upper bound. A bound
//! below 2 rad distorts the paper's transient, in which the estimate passes through 1.7 rad.

use crate::control::parameter_error::at_most;
use crate::control::{ParameterError, Real};

/// Gains and bounds of the observer; its state is the estimate itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeadZoneObserver<F> {
    /// Gain k21 on the load error, 1/s.
    pub load_error_gain: F,
    /// Gain k22 on the elastic torque error, rad/(N m s).
    pub elastic_error_gain: F,
    /// Initial estimate in rad.
    pub initial_rad: F,
    /// Largest estimate in rad.
    pub max_rad: F,
}

impl<F: Real> DeadZoneObserver<F> {
    /// Table 1 of the paper, from its j0, with an upper bound of 3 rad.
    pub fn paper() -> Self {
        Self {
            load_error_gain: F::from_f64(0.01),
            elastic_error_gain: F::from_f64(0.5),
            initial_rad: F::from_f64(0.16),
            max_rad: F::from_f64(3.0),
        }
    }

    /// Checks the initial estimate against its upper bound.
    ///
    /// # Errors
    /// If the initial estimate is beyond the bound.
    pub fn validate(&self) -> Result<(), ParameterError> {
        at_most("dead_zone_initial_rad", self.initial_rad, self.max_rad, "dead_zone_max_rad")
    }

    /// The estimate one period later, from the errors of this sample (forward Euler).
    pub fn step(
        &self,
        estimate_rad: &mut F,
        period_s: F,
        load_error_rad: F,
        elastic_error_nm: F,
        twist_rad: F,
    ) {
        let rate = (self.load_error_gain * load_error_rad + self.elastic_error_gain * elastic_error_nm)
            * twist_rad.sign();
        *estimate_rad = (*estimate_rad + period_s * rate).clamp(F::ZERO, self.max_rad);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimate_grows_on_either_side_with_a_positive_elastic_error() {
        let observer = DeadZoneObserver::<f64>::paper();
        for side in [1.0, -1.0] {
            let mut estimate = 0.16;
            observer.step(&mut estimate, 1e-3, 0.0, 2.0 * side, side);
            assert!((estimate - 0.161).abs() < 1e-15, "side {side}: have {estimate}, want 0.161");
        }
    }

    #[test]
    fn estimate_rests_at_zero_twist_and_stays_in_its_bounds() {
        let observer = DeadZoneObserver::<f64>::paper();
        let mut estimate = 0.16;
        observer.step(&mut estimate, 1e-3, 1.0, 2.0, 0.0);
        assert_eq!(estimate, 0.16);
        observer.step(&mut estimate, 1.0, 0.0, 1e3, 1.0);
        assert_eq!(estimate, 3.0);
        observer.step(&mut estimate, 1.0, 0.0, 1e3, -1.0);
        assert_eq!(estimate, 0.0);
    }
}
