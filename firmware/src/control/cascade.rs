//! The two cascaded loops, equations (16) and (17).
//!
//! C2 turns the load error into a wanted motor position; C1 turns the motor error and the elastic torque error into a
//! torque. The laws of the paper differ only in the [`Compensation`] they add to the cascade.

use crate::control::cascade_signals::CascadeSignals;
use crate::control::feed_forward::FeedForward;
use crate::control::nominal_model::NominalModel;
use crate::law::{ControlOutput, Measurement, Real};

crate::parameters! {
    /// Gains of the cascade, by default those of tables 1 and 2 of the paper.
    pub struct CascadeGains<F> {
        /// K_P1 of C1, motor position to torque.
        k_p1: F32 = 1.0 in 0.0..=1e6, "N m/rad";
        /// K_D1 of C1, motor velocity to torque.
        k_d1: F32 = 0.01 in 0.0..=1e6, "N m s/rad";
        /// K_P2 of C2, load position to motor position.
        k_p2: F32 = 10.0 in 0.0..=1e6, "";
        /// K_D2 of C2, load velocity to motor position.
        k_d2: F32 = 10.0 in 0.0..=1e6, "s";
        /// k1 of C1, elastic torque to torque.
        k_1: F32 = 1.0 in 0.0..=1e6, "";
    }
}

/// The gains by name: a change acts on a torque at once and on no state, so every law with the cascade takes them live.
pub const LIVE_GAINS: &[&str] = &["k_p1", "k_d1", "k_p2", "k_d2", "k_1"];

/// The terms that a law adds to the cascade.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensation<F> {
    /// Amplitude j_hat in rad behind the estimate below.
    pub dead_zone_estimate_rad: F,
    /// Estimated disturbing torque w_hat in N m, equation (19).
    pub disturbing_torque_nm: F,
    /// Lead of the motor over the load in rad.
    pub lead_rad: F,
    /// The free control u of equation (16) in N m.
    pub free_torque_nm: F,
}

/// The cascade with its gains and the nominal mechanics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cascade<F> {
    gains: CascadeGains<F>,
    model: NominalModel<F>,
    feed_forward: FeedForward<F>,
}

impl<F: Real> Cascade<F> {
    /// The cascade for the mechanics of `model`.
    pub fn new(model: &NominalModel<F>, gains: CascadeGains<F>) -> Self {
        Self { gains, model: *model, feed_forward: FeedForward::new(model) }
    }

    /// Replaces the gains.
    pub fn set_gains(&mut self, gains: CascadeGains<F>) {
        self.gains = gains;
    }

    /// Torque and errors at one sample.
    pub fn output(
        &self,
        measurement: &Measurement<F>,
        compensation: &Compensation<F>,
    ) -> ControlOutput<CascadeSignals<F>, F> {
        let m = measurement;
        let load_error = m.load_position_rad - m.reference_position_rad;
        let load_error_rate = m.load_velocity_rad_s - m.reference_velocity_rad_s;
        // (11): e_zeta = K z - zeta_d
        let elastic_error = self.model.stiffness_nm_rad * m.twist_rad + compensation.disturbing_torque_nm
            - self.feed_forward.elastic_torque_nm(m);
        // (17) around the motor position that belongs to the reference.
        let motor_reference = self.model.reduction_ratio * m.reference_position_rad
            - self.gains.k_d2 * load_error_rate
            - self.gains.k_p2 * load_error
            + compensation.lead_rad;
        let motor_error = m.motor_position_rad - motor_reference;
        // Of the rate of theta_e_d only the reference's part is available without another derivative.
        let motor_error_rate =
            m.motor_velocity_rad_s - self.model.reduction_ratio * m.reference_velocity_rad_s;
        // (15), (16)
        let torque = self.feed_forward.motor_torque_nm(m)
            - self.gains.k_1 * elastic_error
            - self.gains.k_d1 * motor_error_rate
            - self.gains.k_p1 * motor_error
            + compensation.free_torque_nm;
        ControlOutput {
            torque_nm: torque,
            signals: CascadeSignals {
                dead_zone_estimate_rad: compensation.dead_zone_estimate_rad,
                disturbing_torque_estimate_nm: compensation.disturbing_torque_nm,
                load_error_rad: load_error,
                motor_error_rad: motor_error,
                elastic_error_nm: elastic_error,
            },
        }
    }
}
