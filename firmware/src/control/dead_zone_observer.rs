//! The estimate of the dead-zone amplitude, equation (19).
//!
//! d(j_hat)/dt = (k21 e_s + k22 e_zeta) sign(z). The paper prints the other sign: it states the law for the side z < 0,
//! from which it approaches, and extends it by symmetry. The estimate is clamped from zero to an upper bound. A bound
//! below 2 rad distorts the paper's transient, in which the estimate passes through 1.7 rad.

use crate::law::{ParameterError, Real};

crate::parameters! {
    /// Gains of the observer, by default those of table 1 of the paper; its state is the estimate itself.
    pub struct DeadZoneObserver<F> {
        /// k21, load position error to the dead-zone estimate.
        k_21: F32 = 0.01 in 0.0..=1e6, "1/s";
        /// k22, elastic torque error to the dead-zone estimate.
        k_22: F32 = 0.5 in 0.0..=1e6, "1/(N m s)";
    }
}

crate::parameters! {
    /// Start and upper bound of an estimate of the dead-zone amplitude.
    pub struct DeadZoneBounds<F> {
        /// Initial estimate.
        dead_zone_initial_rad: F32 = 0.16 in 0.0..=3.0, "rad";
        /// Largest estimate. The paper's transient passes 1.7 rad; a bound below 2 rad distorts it.
        dead_zone_max_rad: F32 = 3.0 in 0.0..=100.0, "rad";
    }
}

impl<F: Real> DeadZoneBounds<F> {
    /// Checks the initial estimate against its upper bound.
    ///
    /// # Errors
    /// If the initial estimate is beyond the bound.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let (initial_rad, max_rad) = (self.dead_zone_initial_rad, self.dead_zone_max_rad);
        ParameterError::at_most("dead_zone_initial_rad", initial_rad, max_rad, "dead_zone_max_rad")
    }
}

impl<F: Real> DeadZoneObserver<F> {
    /// The estimate one period later, from the errors of this sample (forward Euler).
    pub fn step(
        &self,
        estimate_rad: &mut F,
        bounds: &DeadZoneBounds<F>,
        period_s: F,
        load_error_rad: F,
        elastic_error_nm: F,
        twist_rad: F,
    ) {
        let rate = (self.k_21 * load_error_rad + self.k_22 * elastic_error_nm) * twist_rad.sign();
        *estimate_rad = (*estimate_rad + period_s * rate).clamp(F::ZERO, bounds.dead_zone_max_rad);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimate_grows_on_either_side_with_a_positive_elastic_error() {
        let observer = DeadZoneObserver::<f64>::default();
        for side in [1.0, -1.0] {
            let mut estimate = 0.16;
            observer.step(&mut estimate, &DeadZoneBounds::default(), 1e-3, 0.0, 2.0 * side, side);
            assert!((estimate - 0.161).abs() < 1e-15, "side {side}: have {estimate}, want 0.161");
        }
    }

    #[test]
    fn estimate_rests_at_zero_twist_and_stays_in_its_bounds() {
        let observer = DeadZoneObserver::<f64>::default();
        let mut estimate = 0.16;
        observer.step(&mut estimate, &DeadZoneBounds::default(), 1e-3, 1.0, 2.0, 0.0);
        assert_eq!(estimate, 0.16);
        observer.step(&mut estimate, &DeadZoneBounds::default(), 1.0, 0.0, 1e3, 1.0);
        assert_eq!(estimate, 3.0);
        observer.step(&mut estimate, &DeadZoneBounds::default(), 1.0, 0.0, 1e3, -1.0);
        assert_eq!(estimate, 0.0);
    }
}
