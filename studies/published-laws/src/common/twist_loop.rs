//! The inverse of the dead zone, and the motor loop that follows it.
//!
//! A shaft of stiffness K behind a dead zone j transmits the torque C at the twist C / K + j sgn(C):
//!
//! ```text
//! z_d = C_d / K + j_hat sat(C_d / c0)
//! U   = C_d + f_m om_e - k (z - z_d) - b (om_e - N0 om_s)
//! ```

use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::law::{DriveParameters, Measurement, ParameterError};

lashloop_firmware::parameters! {
    /// Gains of the motor loop.
    pub struct TwistGains {
        /// k, twist error to torque.
        twist_gain_nm_rad: F32 = 1.0 in 0.0..=1e6, "N m/rad";
        /// b, velocity of the twist to torque; at most the motor's inertia divided by the control period.
        twist_damping_nm_s_rad: F32 = 0.04 in 0.0..=1e6, "N m s/rad";
        /// c0, transmitted torque within which the motor crosses the gap.
        crossing_nm: F32 = 0.05 in 1e-6..=1e6, "N m";
    }
}

/// The loop with its constants.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TwistLoop {
    gains: TwistGains,
    pub(crate) model: NominalModel,
    /// Largest transmitted torque (N m).
    pub(crate) limit_nm: f32,
}

impl TwistLoop {
    pub(crate) fn new(
        gains: TwistGains,
        model: NominalModel,
        drive: &DriveParameters,
    ) -> Result<Self, ParameterError> {
        // A held torque reverses the motor within a period if it damps more than the motor's momentum.
        ParameterError::at_most(
            "twist_damping_nm_s_rad",
            gains.twist_damping_nm_s_rad,
            model.motor_inertia_kg_m2 / drive.period_s(),
            "motor_inertia_kg_m2 divided by the control period",
        )?;
        Ok(Self { gains, model, limit_nm: drive.torque_limit_nm })
    }

    /// Motor torque that transmits `transmitted_nm` over a dead zone and a compliance.
    pub(crate) fn torque_nm(
        &self,
        m: &Measurement<f32>,
        load_velocity_rad_s: f32,
        transmitted_nm: f32,
        dead_zone_rad: f32,
        compliance_rad_nm: f32,
    ) -> f32 {
        let TwistGains { twist_gain_nm_rad, twist_damping_nm_s_rad, crossing_nm } = self.gains;
        let side = (transmitted_nm / crossing_nm).clamp(-1.0, 1.0);
        let wanted_rad = transmitted_nm * compliance_rad_nm + dead_zone_rad * side;
        transmitted_nm + self.model.motor_friction_nm_s_rad * m.motor_velocity_rad_s
            - twist_gain_nm_rad * (m.twist_rad - wanted_rad)
            - twist_damping_nm_s_rad
                * (m.motor_velocity_rad_s - self.model.reduction_ratio * load_velocity_rad_s)
    }
}
