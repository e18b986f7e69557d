//! The choice of a control law at run time.

use crate::control::backlash_inverse::BacklashInverse;
use crate::control::merzouki::Merzouki;
use crate::control::pd::Pd;
use crate::control::{ControlOutput, Measurement, Real};

/// Any of the control laws, with its state.
#[derive(Debug, Clone, PartialEq)]
pub enum Law<F: Real> {
    /// The cascade before compensation.
    Pd(Pd<F>),
    /// The cascade after compensation.
    Merzouki(Merzouki<F>),
    /// The gap inverted in the torque domain.
    BacklashInverse(BacklashInverse<F>),
}

impl<F: Real> Law<F> {
    /// The torque for one sample, before the drive's limit.
    pub fn step(&mut self, measurement: &Measurement<F>) -> ControlOutput<F> {
        match self {
            Self::Pd(law) => law.step(measurement),
            Self::Merzouki(law) => law.step(measurement),
            Self::BacklashInverse(law) => law.step(measurement),
        }
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::control::backlash_inverse::{BacklashInverseGains, BacklashInverseSetting};
    use crate::control::cascade::CascadeGains;
    use crate::control::dead_zone_observer::DeadZoneObserver;
    use crate::control::merzouki::DisturbingTorqueSource;
    use crate::control::momentum_observer::MomentumObserver;
    use crate::control::nominal_model::NominalModel;

    /// The paper's start: at rest, the load at pi/2 and the motor at 3 pi/2.
    fn start() -> Measurement<f64> {
        Measurement {
            motor_position_rad: 3.0 * FRAC_PI_2,
            load_position_rad: FRAC_PI_2,
            ..Measurement::at_rest()
        }
    }

    fn backlash_inverse() -> Law<f64> {
        let setting = BacklashInverseSetting {
            momentum_observer_rad_s: 60.0,
            dead_zone_initial_rad: 0.16,
            dead_zone_max_rad: 3.0,
            load_resolution_rad: 1e-4,
            torque_limit_nm: 20.0,
            period_s: 1e-3,
        };
        let law = BacklashInverse::new(&NominalModel::paper(), BacklashInverseGains::paper(), setting);
        Law::BacklashInverse(law.expect("valid"))
    }

    /// The laws of the paper.
    fn laws() -> [Law<f64>; 3] {
        let (model, gains, observer) =
            (NominalModel::paper(), CascadeGains::paper(), DeadZoneObserver::paper());
        let observed = DisturbingTorqueSource::Observed(MomentumObserver::new(&model, 60.0, 1e-3));
        let merzouki =
            |source| Law::Merzouki(Merzouki::new(&model, gains, observer, source, 1e-3).expect("valid"));
        [Law::Pd(Pd::new(&model, gains)), merzouki(observed), merzouki(DisturbingTorqueSource::AsPrinted)]
    }

    #[test]
    fn without_twist_every_law_of_the_paper_gives_one_torque() {
        for mut law in laws() {
            let output = law.step(&start());
            // Without twist the compensation is zero: -(theta_e + 10 theta_s).
            assert!((output.torque_nm + 13.0 * FRAC_PI_2).abs() < 1e-9, "have {} N m", output.torque_nm);
            assert_eq!(output.dead_zone_estimate_rad, 0.16);
        }
    }

    #[test]
    fn laws_differ_by_lead_and_free_torque_at_a_wound_spring() {
        let wound = Measurement { twist_rad: 2.0, motor_position_rad: 3.0 * FRAC_PI_2 + 2.0, ..start() };
        let [pd, merzouki, as_printed] = laws().map(|mut law| law.step(&wound).torque_nm);
        let w_hat = -0.64 * libm::tanh(2.0 / 0.64);
        assert!((as_printed - (pd - w_hat)).abs() < 1e-12, "merzouki-as-printed: have {as_printed}, pd {pd}");
        // Lead -w_hat, and w - w_hat before any observation: C_obs = 0, w = -K z.
        assert!(
            (merzouki - (pd - w_hat - w_hat - 2.0 - w_hat)).abs() < 1e-12,
            "merzouki: have {merzouki}, pd {pd}"
        );
    }

    #[test]
    fn merzouki_laws_use_the_estimate_from_before_its_update() {
        let wound = Measurement { twist_rad: 2.0, ..start() };
        for mut law in laws().into_iter().skip(1) {
            let first = law.step(&wound);
            let second = law.step(&wound);
            assert_eq!(first.dead_zone_estimate_rad, 0.16);
            let rate = 0.01 * first.load_error_rad + 0.5 * first.elastic_error_nm;
            assert!((second.dead_zone_estimate_rad - 0.16 - 1e-3 * rate).abs() < 1e-15);
        }
    }

    #[test]
    fn perfect_tracking_needs_the_torque_of_the_rigid_mechanics() {
        // On the reference in position and velocity, the spring wound by exactly zeta_d and the motor at the position
        // of (17), only the feed-forward remains.
        let moving = Measurement {
            motor_position_rad: 3.0,
            motor_velocity_rad_s: 1.5,
            load_position_rad: 1.0,
            load_velocity_rad_s: 0.5,
            twist_rad: (7.5 * 0.2 + 16.0 * 0.5) / 3.0,
            reference_position_rad: 1.0,
            reference_velocity_rad_s: 0.5,
            reference_acceleration_rad_s2: 0.2,
            applied_torque_nm: 0.0,
        };
        let [mut pd, ..] = laws();
        let want = (9.72e-4 * 3.0 + 7.5 / 3.0) * 0.2 + (4.3e-4 * 3.0 + 16.0 / 3.0) * 0.5;
        let have = pd.step(&moving).torque_nm;
        assert!((have - want).abs() < 1e-12, "have {have}, want {want} N m");
    }

    #[test]
    fn a_measurement_of_nan_makes_the_torque_non_finite() {
        for mut law in laws().into_iter().chain([backlash_inverse()]) {
            let invalid = Measurement { load_position_rad: f64::NAN, ..start() };
            assert!(!law.step(&invalid).torque_nm.is_finite());
        }
    }
}
