//! Compliance and half gap of the transmission, by recursive least squares.
//!
//! In contact |z| = kappa |C| + j, with kappa = 1 / K. Twist and transmitted torque are both measured at the motor's
//! side, so neither contains the friction on the load, which biases the paper's estimate. Both estimates are clamped to
//! bounds. Process noise on the half gap lets the estimate follow wear; the compliance of a shaft is constant.
//!
//! A sample counts if torque and twist have one sign and the torque is large enough for contact to be certain. The
//! twist must also be slow: while it moves, every delay between torque and position looks like a piece of gap.

use nalgebra::{Matrix2, Vector2};

use crate::law::Real;

/// Variance of the twist of one sample in rad^2. It is large because the errors of samples one period apart are
/// strongly correlated.
const SAMPLE_VARIANCE_RAD2: f64 = 2.0;
/// Variance of the initial half gap in rad^2, and of the compliance relative to the nominal one.
const INITIAL_VARIANCE: f64 = 0.09;
/// Standard deviation of j_hat over the square root of its covariance: [`SAMPLE_VARIANCE_RAD2`] sets the gain, not the true
/// scatter of a sample. Fitted on random plants, so that 95 % of the errors are within two deviations.
const DEVIATION_SCALE: f64 = 0.12;
/// Growth of the half gap's variance per sample in rad^2, up to the initial variance. The estimate follows wear within
/// some ten seconds of contact.
pub(in crate::control) const GAP_PROCESS_NOISE_RAD2: f64 = 1e-7;
/// Fraction of a sample's misfit in the mean of the last ones, and the misfit's weight in the deviation. A spring that fits the
/// model misses by some 15 mrad; one wound with less torque than commanded, by 60 mrad and more.
const MISFIT_FRACTION: f64 = 0.01;
const MISFIT_WEIGHT: f64 = 0.27;
/// Range of the compliance relative to the nominal one.
const COMPLIANCE_RANGE: (f64, f64) = (0.5, 2.0);
/// Largest rate of the twist in rad/s at which a sample counts.
const FASTEST_TWIST_RAD_S: f64 = 3.0;

/// Mean misfit in rad after a sample whose twist differs from its prediction by `error_rad`.
pub(in crate::control) fn mean_misfit_rad<F: Real>(misfit_rad: F, error_rad: F) -> F {
    misfit_rad + F::from_f64(MISFIT_FRACTION) * (error_rad.abs() - misfit_rad)
}

/// Prior values and bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct Identification<F> {
    /// Nominal compliance 1 / K in rad/(N m).
    pub(in crate::control) nominal_rad_nm: F,
    /// Half gap at the start in rad.
    pub(in crate::control) initial_rad: F,
    /// Largest half gap in rad.
    pub(in crate::control) max_rad: F,
    /// Smallest transmitted torque in N m at which a sample counts.
    pub(in crate::control) min_torque_nm: F,
    /// Growth of the half gap's variance per sample in rad^2; zero gives plain least squares.
    pub(in crate::control) process_noise_rad2: F,
}

/// The estimates and their covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct Estimate<F: Real> {
    /// Compliance in rad/(N m), half gap in rad.
    parameters: Vector2<F>,
    covariance: Matrix2<F>,
}

impl<F: Real> Estimate<F> {
    /// Compliance kappa in rad/(N m).
    pub(in crate::control) fn compliance_rad_nm(&self) -> F {
        self.parameters.x
    }

    /// Half gap j_hat in rad.
    pub(in crate::control) fn dead_zone_rad(&self) -> F {
        self.parameters.y
    }
}

impl<F: Real> Identification<F> {
    /// The prior values.
    pub(in crate::control) fn initial_estimate(&self) -> Estimate<F> {
        let variance = F::from_f64(INITIAL_VARIANCE);
        let nominal = self.nominal_rad_nm;
        Estimate {
            parameters: Vector2::new(nominal, self.initial_rad),
            covariance: Matrix2::new(variance * nominal * nominal, F::ZERO, F::ZERO, variance),
        }
    }

    /// Updates the estimate by one sample, if the sample counts. Returns the twist less its prediction in rad.
    // Two laws step it: out of line, the call costs each of them some ten instructions.
    #[inline(always)]
    pub(in crate::control) fn step(
        &self,
        estimate: &mut Estimate<F>,
        transmitted_nm: F,
        twist_rad: F,
        twist_rate_rad_s: F,
    ) -> Option<F> {
        let torque = transmitted_nm.abs();
        let counts = torque > self.min_torque_nm
            && transmitted_nm * twist_rad > F::ZERO
            && twist_rate_rad_s.abs() < F::from_f64(FASTEST_TWIST_RAD_S);
        counts.then(|| self.update(estimate, torque, twist_rad.abs()))
    }

    /// Standard deviation of j_hat in rad by the samples alone, without the prior value; one radian when nothing is learnt.
    /// Samples that contradict the model, such as those of a motor with less torque than commanded, add their misfit.
    pub(in crate::control) fn dead_zone_deviation_rad(&self, estimate: &Estimate<F>, misfit_rad: F) -> F {
        let variance = estimate.covariance.m22;
        let samples = F::ONE - variance / F::from_f64(INITIAL_VARIANCE);
        let scale = F::from_f64(DEVIATION_SCALE * DEVIATION_SCALE);
        if samples <= variance * scale {
            return F::ONE;
        }
        let misfit = F::from_f64(MISFIT_WEIGHT) * misfit_rad;
        (scale * variance / samples + misfit * misfit).sqrt()
    }

    fn update(&self, estimate: &mut Estimate<F>, torque_nm: F, twist_rad: F) -> F {
        let regressor = Vector2::new(torque_nm, F::ONE);
        let spread = estimate.covariance * regressor;
        let gain = spread / (F::from_f64(SAMPLE_VARIANCE_RAD2) + regressor.dot(&spread));
        let error = twist_rad - estimate.parameters.dot(&regressor);
        estimate.covariance -= gain * spread.transpose();
        estimate.parameters += gain * error;
        if estimate.covariance.m22 < F::from_f64(INITIAL_VARIANCE) {
            estimate.covariance.m22 += self.process_noise_rad2;
        }
        let (low, high) = COMPLIANCE_RANGE;
        let nominal = self.nominal_rad_nm;
        estimate.parameters.x =
            estimate.parameters.x.clamp(F::from_f64(low) * nominal, F::from_f64(high) * nominal);
        estimate.parameters.y = estimate.parameters.y.clamp(F::ZERO, self.max_rad);
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identification() -> Identification<f64> {
        Identification {
            nominal_rad_nm: 1.0,
            initial_rad: 0.3,
            max_rad: 0.8,
            min_torque_nm: 0.4,
            process_noise_rad2: 0.0,
        }
    }

    /// Torques that wind the spring on both sides.
    fn torque_nm(k: i32) -> f64 {
        3.0 * (f64::from(k) * 1e-3).sin()
    }

    fn estimate_after(samples: i32, twist_rad: impl Fn(f64) -> f64) -> Estimate<f64> {
        let identification = identification();
        let mut estimate = identification.initial_estimate();
        for torque in (0..samples).map(torque_nm) {
            identification.step(&mut estimate, torque, twist_rad(torque), 0.0);
        }
        estimate
    }

    #[test]
    fn contact_on_both_sides_identifies_gap_and_compliance() {
        let estimate = estimate_after(20_000, |torque| 1.3 * torque + 0.1 * torque.signum());
        let (compliance, gap) = (estimate.compliance_rad_nm(), estimate.dead_zone_rad());
        assert!((compliance - 1.3).abs() < 2e-3, "have {compliance} rad/(N m), want 1.3");
        assert!((gap - 0.1).abs() < 4e-3, "have {gap} rad, want 0.1");
    }

    #[test]
    fn deviation_shrinks_with_samples_and_grows_with_their_misfit() {
        let identification = identification();
        let deviation = |samples, twist_rad: fn(f64) -> f64| {
            let (mut estimate, mut misfit_rad) = (identification.initial_estimate(), 0.0);
            for torque in (0..samples).map(torque_nm) {
                if let Some(error) = identification.step(&mut estimate, torque, twist_rad(torque), 0.0) {
                    misfit_rad = mean_misfit_rad(misfit_rad, error);
                }
            }
            identification.dead_zone_deviation_rad(&estimate, misfit_rad)
        };
        assert_eq!(deviation(0, |torque| torque), 1.0, "nothing learnt");
        let few = deviation(400, |torque| torque + 0.1 * torque.signum());
        let many = deviation(20_000, |torque| torque + 0.1 * torque.signum());
        assert!(many < 0.005 && few > 3.0 * many, "{few} rad, then {many} rad");
        let stiff = deviation(20_000, |torque| 0.2 * torque);
        let limited = deviation(20_000, |torque| torque.clamp(-1.0, 1.0) + 0.1 * torque.signum());
        assert!(
            stiff > 0.05 && limited > 0.05,
            "{stiff} rad beyond the compliance's range, {limited} rad at 1 N m"
        );
    }

    #[test]
    fn recursion_equals_the_batch_solution() {
        // The recursion without bounds is the solution of (P0^-1 + sum phi phi' / R) x = P0^-1 x0 + sum phi y / R.
        let twist = |torque: f64| 1.2 * torque.abs() + 0.1 + 0.02 * (17.0 * torque).sin();
        let prior = identification().initial_estimate();
        let mut information = prior.covariance.map_diagonal(|variance| 1.0 / variance);
        let mut normal = Matrix2::from_diagonal(&information);
        information.component_mul_assign(&prior.parameters);
        let mut estimate = prior;
        for torque in (0..5000).map(torque_nm).filter(|torque| torque.abs() > 0.4) {
            let regressor = Vector2::new(torque.abs(), 1.0);
            normal += regressor * regressor.transpose() / SAMPLE_VARIANCE_RAD2;
            information += regressor * twist(torque) / SAMPLE_VARIANCE_RAD2;
            identification().step(&mut estimate, torque, twist(torque) * torque.signum(), 0.0);
        }
        // Cramer's rule: nalgebra's inverse needs its own trait for reals.
        let determinant = normal.m11 * normal.m22 - normal.m12 * normal.m21;
        let compliance = (normal.m22 * information.x - normal.m12 * information.y) / determinant;
        let gap = (normal.m11 * information.y - normal.m21 * information.x) / determinant;
        assert!((estimate.compliance_rad_nm() - compliance).abs() < 1e-9, "{estimate:?}, want {compliance}");
        assert!((estimate.dead_zone_rad() - gap).abs() < 1e-9, "{estimate:?}, want {gap}");
    }

    #[test]
    fn estimates_stay_in_their_bounds_for_any_measurement() {
        let identification = identification();
        // Far too compliant, far too stiff, and noise of no physical transmission.
        let twists: [fn(f64) -> f64; 3] = [
            |torque| 9.0 * torque,
            |torque| 0.01 * torque,
            |torque| torque * (1e4 * torque).sin().abs() * 50.0,
        ];
        let (mut lowest, mut highest) = ([f64::MAX; 2], [f64::MIN; 2]);
        for twist in twists {
            let mut estimate = identification.initial_estimate();
            for torque in (0..20_000).map(torque_nm) {
                identification.step(&mut estimate, torque, twist(torque), 0.0);
                for (of, have) in
                    [estimate.compliance_rad_nm(), estimate.dead_zone_rad()].into_iter().enumerate()
                {
                    lowest[of] = lowest[of].min(have);
                    highest[of] = highest[of].max(have);
                }
            }
        }
        assert_eq!((lowest, highest), ([0.5, 0.0], [2.0, 0.8]), "the bounds are reached and not exceeded");
    }

    #[test]
    fn samples_off_contact_of_low_torque_or_in_fast_motion_do_not_count() {
        let identification = identification();
        let mut estimate = identification.initial_estimate();
        identification.step(&mut estimate, 2.0, -1.0, 0.0);
        identification.step(&mut estimate, 0.3, 1.0, 0.0);
        identification.step(&mut estimate, 2.0, 1.0, -3.5);
        assert_eq!(estimate, identification.initial_estimate());
        identification.step(&mut estimate, 2.0, 1.0, -2.5);
        assert_ne!(estimate, identification.initial_estimate());
    }

    #[test]
    fn the_estimate_follows_a_gap_that_wears() {
        let identification =
            Identification { process_noise_rad2: GAP_PROCESS_NOISE_RAD2, ..identification() };
        let mut estimate = identification.initial_estimate();
        let mut error_after = |samples: core::ops::Range<i32>, gap_rad: f64| {
            for torque in samples.map(torque_nm) {
                identification.step(&mut estimate, torque, torque + gap_rad * torque.signum(), 0.0);
            }
            estimate.dead_zone_rad() - gap_rad
        };
        assert!(error_after(0..60_000, 0.1).abs() < 2e-3);
        let (at_once, later) = (error_after(60_000..60_010, 0.3), error_after(60_010..90_000, 0.3));
        assert!(at_once < -0.19 && later.abs() < 0.02, "{at_once} rad, half a minute later {later} rad");
    }

    #[test]
    fn a_million_samples_at_one_torque_keep_single_precision_stable() {
        let identification = Identification {
            nominal_rad_nm: 1.0_f32,
            initial_rad: 0.3,
            max_rad: 0.8,
            min_torque_nm: 0.4,
            process_noise_rad2: GAP_PROCESS_NOISE_RAD2 as f32,
        };
        let mut estimate = identification.initial_estimate();
        for _ in 0..1_000_000 {
            identification.step(&mut estimate, 1.5, 1.75, 0.0);
        }
        // One torque gives one equation: the error splits in the ratio of the variances.
        let twist = estimate.compliance_rad_nm() * 1.5 + estimate.dead_zone_rad();
        assert!((twist - 1.75).abs() < 5e-4, "{estimate:?} predicts {twist} rad");
        assert!(estimate.covariance.m11 > 0.0 && estimate.covariance.m22 > 0.0, "{estimate:?}");
        assert!((estimate.dead_zone_rad() - (0.3 - 0.05 / 3.25)).abs() < 1e-3, "{estimate:?}");
    }
}
