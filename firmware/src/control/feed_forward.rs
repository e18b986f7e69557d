//! The torques of a moving reference, equations (11) and (15).
//!
//! The second derivative of zeta_d in (15) holds that of w_hat and with it an algebraic loop through the twist's
//! acceleration, with gain one at z = 0. The derivative can't be implemented and is omitted, with its f_m/K part, 4e-4
//! of the torque. With a constant reference both torques are zero.

use crate::control::nominal_model::NominalModel;
use crate::law::{Measurement, Real};

/// Feed-forward of a moving reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedForward<F> {
    load_inertia_at_motor: F,
    load_friction_at_motor: F,
    whole_inertia: F,
    whole_friction: F,
}

impl<F: Real> FeedForward<F> {
    /// Feed-forward for the mechanics of `model`.
    pub fn new(model: &NominalModel<F>) -> Self {
        let load_inertia_at_motor = model.load_inertia_kg_m2 / model.reduction_ratio;
        let load_friction_at_motor = model.load_friction_nm_s_rad / model.reduction_ratio;
        Self {
            load_inertia_at_motor,
            load_friction_at_motor,
            whole_inertia: model.motor_inertia_kg_m2 * model.reduction_ratio + load_inertia_at_motor,
            whole_friction: model.motor_friction_nm_s_rad * model.reduction_ratio + load_friction_at_motor,
        }
    }

    /// The reference's part of the wanted elastic torque zeta_d in N m, equation (11): it accelerates the load.
    pub fn elastic_torque_nm(&self, measurement: &Measurement<F>) -> F {
        self.load_inertia_at_motor * measurement.reference_acceleration_rad_s2
            + self.load_friction_at_motor * measurement.reference_velocity_rad_s
    }

    /// The reference's part of the motor torque in N m, equation (15): it accelerates motor and load.
    pub fn motor_torque_nm(&self, measurement: &Measurement<F>) -> F {
        self.whole_inertia * measurement.reference_acceleration_rad_s2
            + self.whole_friction * measurement.reference_velocity_rad_s
    }
}
