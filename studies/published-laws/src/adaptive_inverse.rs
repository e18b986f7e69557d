//! `adaptive-inverse`: a linear velocity cascade behind an inverse of the dead zone that adapts by the gradient.
//!
//! After G. Tao, P.V. Kokotovic, "Adaptive control of systems with unknown output backlash", IEEE Transactions on Automatic
//! Control 40 (1995) 326-330, and their other papers on adaptive inverses: a linear controller for the plant without the
//! nonlinearity, an inverse of it, and a normalised gradient with projection for the unknown width. Restated from the idea,
//! with these deviations:
//!
//! - A dead zone in front of an elastic shaft takes the place of backlash, so its inverse is that of a dead zone.
//! - The gradient descends the error of the transmitted torque, which the motor observes, not the tracking error.
//!
//! ```text
//! om_d = om_r - sat(lambda e, v_max)
//! C_d  = (f_s om_d + k_v (om_d - om_s) + k_i int(om_d - om_s)) / N0
//! dj_hat/dt = -gamma s (C_obs - K (z_f - s j_hat)) K / (1 + K^2),   s = sgn(C_obs), while |C_obs| > 0.4 N m, z slow
//! ```

use lashloop_firmware::control::momentum_observer::MomentumObserver;
use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

use crate::common::arrival::{Arrival, ArrivalBand, Phase};
use crate::common::integral::Integral;
use crate::common::twist_loop::{TwistGains, TwistLoop};

/// Pole of the observed torque, and of the twist that is compared with it (rad/s).
const OBSERVER_POLE_RAD_S: f32 = 60.0;
/// Smallest torque and largest rate of the twist at which the gradient acts.
const CONTACT_NM: f32 = 0.4;
const FASTEST_TWIST_RAD_S: f32 = 3.0;
/// Projection of the estimate (rad).
const LARGEST_GAP_RAD: f32 = 0.8;

lashloop_firmware::parameters! {
    /// Gains of the velocity cascade.
    pub struct AdaptiveGains {
        /// lambda, load error to commanded load velocity.
        adaptive_rate_1_s: F32 = 2.5 in 0.0..=1e4, "1/s";
        /// v_max, largest commanded load velocity relative to the reference.
        adaptive_speed_rad_s: F32 = 1.5 in 0.0..=1e4, "rad/s";
        /// k_v, load velocity error to torque at the load.
        adaptive_gain_nm_s_rad: F32 = 30.0 in 0.0..=1e5, "N m s/rad";
        /// k_i, integral of the load velocity error to torque at the load.
        adaptive_integral_nm_rad: F32 = 60.0 in 0.0..=1e5, "N m/rad";
        /// Limit of that integral at the load.
        adaptive_integral_limit_nm: F32 = 8.0 in 0.0..=1e5, "N m";
    }
}

lashloop_firmware::parameters! {
    /// Adaptation of the gap.
    pub struct Adaptation {
        /// gamma, gain of the gradient.
        adaptation_rate_1_s: F32 = 5.0 in 0.0..=1e4, "1/s";
    }
}

lashloop_firmware::signals! {
    /// Signals of the law.
    pub struct AdaptiveSignals {
        /// j_hat, as used in this torque.
        dead_zone_estimate_rad: "rad",
    }
}

/// The law with its constants and its state.
pub struct AdaptiveInverse {
    gains: AdaptiveGains,
    rate_per_period: f32,
    twist_loop: TwistLoop,
    observer: MomentumObserver<f32>,
    lag_per_period: f32,
    integral: Integral,
    arrival: Arrival,
    momentum_balance_nm: f32,
    /// `None` before the first sample.
    lagging_twist_rad: Option<f32>,
    dead_zone_rad: f32,
}

impl ControlLaw for AdaptiveInverse {
    const NAME: &'static str = "adaptive-inverse";
    type Parameters = (AdaptiveGains, Adaptation, TwistGains, ArrivalBand, NominalModel);
    type Signals = AdaptiveSignals;

    fn new(
        (gains, adaptation, twist, band, model): Self::Parameters,
        drive: &DriveParameters,
    ) -> Result<Self, ParameterError> {
        let period_s = drive.period_s();
        Ok(Self {
            rate_per_period: adaptation.adaptation_rate_1_s * period_s,
            twist_loop: TwistLoop::new(twist, model, drive)?,
            observer: MomentumObserver::new(&model, OBSERVER_POLE_RAD_S, period_s),
            lag_per_period: OBSERVER_POLE_RAD_S * period_s,
            integral: Integral::new(
                gains.adaptive_integral_nm_rad,
                gains.adaptive_integral_limit_nm,
                period_s,
            ),
            gains,
            arrival: Arrival::new(band, drive),
            momentum_balance_nm: 0.0,
            lagging_twist_rad: None,
            dead_zone_rad: model.dead_zone_rad,
        })
    }

    fn step(&mut self, m: &Measurement<f32>) -> ControlOutput<AdaptiveSignals> {
        let phase = self.arrival.step(m);
        self.adapt(m, phase);
        let (gains, model) = (&self.gains, &self.twist_loop.model);
        let error_rad = m.load_position_rad - m.reference_position_rad;
        let approach_rad_s = (gains.adaptive_rate_1_s * error_rad)
            .clamp(-gains.adaptive_speed_rad_s, gains.adaptive_speed_rad_s);
        let wanted_rad_s =
            if phase == Phase::Approaching { m.reference_velocity_rad_s - approach_rad_s } else { 0.0 };
        let velocity_error = wanted_rad_s - m.load_velocity_rad_s;
        let load_nm = model.load_friction_nm_s_rad * wanted_rad_s
            + gains.adaptive_gain_nm_s_rad * velocity_error
            + self.integral.value;
        let requested_nm = load_nm / model.reduction_ratio;
        let limit_nm = self.twist_loop.limit_nm;
        let transmitted_nm = requested_nm.clamp(-limit_nm, limit_nm);
        let at_limit = transmitted_nm != requested_nm && requested_nm * velocity_error > 0.0;
        self.integral.step(velocity_error, at_limit, phase);
        let compliance_rad_nm = 1.0 / model.stiffness_nm_rad;
        let torque_nm = self.twist_loop.torque_nm(
            m,
            m.load_velocity_rad_s,
            transmitted_nm,
            self.dead_zone_rad,
            compliance_rad_nm,
        );
        ControlOutput { torque_nm, signals: AdaptiveSignals { dead_zone_estimate_rad: self.dead_zone_rad } }
    }
}

impl AdaptiveInverse {
    fn adapt(&mut self, m: &Measurement<f32>, phase: Phase) {
        let stiffness = self.twist_loop.model.stiffness_nm_rad;
        let transmitted_nm = self.observer.step(&mut self.momentum_balance_nm, m);
        let lagging_rad = self.lagging_twist_rad.unwrap_or(m.twist_rad);
        let behind_rad = m.twist_rad - lagging_rad;
        let lagging_rad = lagging_rad + self.lag_per_period * behind_rad;
        self.lagging_twist_rad = Some(lagging_rad);
        let slow = (OBSERVER_POLE_RAD_S * behind_rad).abs() < FASTEST_TWIST_RAD_S;
        let contact = transmitted_nm.abs() > CONTACT_NM && transmitted_nm * lagging_rad > 0.0;
        if phase == Phase::Approaching && contact && slow {
            let side = 1.0_f32.copysign(transmitted_nm);
            let error_nm = transmitted_nm - stiffness * (lagging_rad - side * self.dead_zone_rad);
            let descent = side * error_nm * stiffness / (1.0 + stiffness * stiffness);
            self.dead_zone_rad =
                (self.dead_zone_rad - self.rate_per_period * descent).clamp(0.0, LARGEST_GAP_RAD);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimate_converges_to_the_gap_of_a_blocked_motor() {
        let mut law = AdaptiveInverse::new(Default::default(), &DriveParameters::default()).expect("valid");
        // 2 N m at a twist of 2.3 rad and a stiffness of 1 N m/rad: half a gap of 0.3 rad.
        let m = Measurement {
            load_position_rad: -1.0,
            twist_rad: 2.3,
            applied_torque_nm: 2.0,
            ..Measurement::default()
        };
        let estimate_rad = (0..3000).map(|_| law.step(&m).signals.dead_zone_estimate_rad).last();
        assert!((estimate_rad.expect("stepped") - 0.3).abs() < 1e-3, "{estimate_rad:?}");
    }
}
