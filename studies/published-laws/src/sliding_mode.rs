//! `sliding-mode`: a sliding surface of the load, behind an inverse of the nominal gap.
//!
//! After M.L. Corradini, G. Orlando, "Robust stabilization of nonlinear uncertain plants with backlash or dead zone in the
//! actuator", IEEE Transactions on Control Systems Technology 10 (2002) 158-166: a sliding mode is robust against bounded
//! errors of the plant, and an inverse with nominal parameters removes the nonlinearity of the actuator but for a bounded
//! rest. Restated from the idea for a dead zone between motor and load.
//!
//! ```text
//! e_l = sat(e, v_max / lambda),   s = om_s - om_r + lambda e_l
//! C_d = (f_s om_s + F_c sat(om_s / 0.1) - J_s lambda (om_s - om_r) [|e| inside] - eta sat(s / phi)) / N0
//! ```
//!
//! Deviations: eta acts through a boundary layer phi, because a shaft can't follow a torque that switches; the layer has an
//! integral of s, which removes its static error and is unloaded on arrival (module `arrival`); the surface bends to a
//! constant velocity v_max; the motor follows the inverse by proportional feedback (module `twist_loop`).

use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

use crate::common::arrival::{Arrival, ArrivalBand, Phase};
use crate::common::integral::Integral;
use crate::common::twist_loop::{TwistGains, TwistLoop};

/// Load velocity over which the compensation of dry friction changes its sign (rad/s).
const FRICTION_WIDTH_RAD_S: f32 = 0.1;

lashloop_firmware::parameters! {
    /// The surface and the gains towards it.
    pub struct SlidingGains {
        /// lambda, slope of the surface.
        surface_rate_1_s: F32 = 2.5 in 0.01..=1e4, "1/s";
        /// v_max, load velocity of the surface far from the target.
        surface_speed_rad_s: F32 = 1.5 in 0.0..=1e4, "rad/s";
        /// eta, largest torque towards the surface, at the load.
        sliding_torque_nm: F32 = 20.0 in 0.0..=1e5, "N m";
        /// phi, boundary layer.
        sliding_layer_rad_s: F32 = 0.5 in 1e-6..=1e4, "rad/s";
        /// Integral of s to torque at the load.
        sliding_integral_nm_rad: F32 = 50.0 in 0.0..=1e5, "N m/rad";
        /// F_c, nominal dry friction of the load; the friction is not compensated at zero.
        load_coulomb_nm: F32 = 3.4 in 0.0..=1e6, "N m";
    }
}

lashloop_firmware::signals! {
    /// Signals of the law.
    pub struct SlidingSignals {
        /// s, distance from the surface.
        surface_rad_s: "rad/s",
    }
}

/// The law with its constants and its state.
pub struct SlidingMode {
    gains: SlidingGains,
    twist_loop: TwistLoop,
    integral: Integral,
    arrival: Arrival,
}

impl ControlLaw for SlidingMode {
    const NAME: &'static str = "sliding-mode";
    type Parameters = (SlidingGains, TwistGains, ArrivalBand, NominalModel);
    type Signals = SlidingSignals;

    fn new(
        (gains, twist, band, model): Self::Parameters,
        drive: &DriveParameters,
    ) -> Result<Self, ParameterError> {
        Ok(Self {
            gains,
            twist_loop: TwistLoop::new(twist, model, drive)?,
            integral: Integral::new(gains.sliding_integral_nm_rad, gains.sliding_torque_nm, drive.period_s()),
            arrival: Arrival::new(band, drive),
        })
    }

    fn step(&mut self, m: &Measurement<f32>) -> ControlOutput<SlidingSignals> {
        let (gains, model) = (&self.gains, &self.twist_loop.model);
        let phase = self.arrival.step(m);
        let velocity_rad_s = m.load_velocity_rad_s - m.reference_velocity_rad_s;
        let error_rad = m.load_position_rad - m.reference_position_rad;
        let wanted_rad_s = gains.surface_rate_1_s * error_rad;
        let bent = wanted_rad_s.abs() > gains.surface_speed_rad_s;
        let surface_rad_s =
            velocity_rad_s + wanted_rad_s.clamp(-gains.surface_speed_rad_s, gains.surface_speed_rad_s);
        let slope_1_s = if bent { 0.0 } else { gains.surface_rate_1_s };
        let load_nm = match phase {
            Phase::Approaching => {
                let moving = (m.load_velocity_rad_s / FRICTION_WIDTH_RAD_S).clamp(-1.0, 1.0);
                model.load_friction_nm_s_rad * m.load_velocity_rad_s + gains.load_coulomb_nm * moving
                    - model.load_inertia_kg_m2 * slope_1_s * velocity_rad_s
                    - gains.sliding_torque_nm * (surface_rad_s / gains.sliding_layer_rad_s).clamp(-1.0, 1.0)
                    + self.integral.value
            }
            Phase::Arriving | Phase::Holding => self.integral.value,
        };
        let requested_nm = load_nm / model.reduction_ratio;
        let transmitted_nm = requested_nm.clamp(-self.twist_loop.limit_nm, self.twist_loop.limit_nm);
        // Outside the layer eta acts, and the integral rests.
        let at_limit = transmitted_nm != requested_nm || surface_rad_s.abs() > gains.sliding_layer_rad_s;
        self.integral.step(-surface_rad_s, at_limit, phase);
        let torque_nm = self.twist_loop.torque_nm(
            m,
            m.load_velocity_rad_s,
            transmitted_nm,
            model.dead_zone_rad,
            1.0 / model.stiffness_nm_rad,
        );
        ControlOutput { torque_nm, signals: SlidingSignals { surface_rad_s } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn load_on_the_surface_needs_the_torque_of_its_deceleration_only() {
        let gains = SlidingGains { load_coulomb_nm: 0.0, ..SlidingGains::default() };
        let parameters = (gains, TwistGains::default(), ArrivalBand::default(), NominalModel::default());
        let mut law = SlidingMode::new(parameters, &DriveParameters::default()).expect("valid");
        // On the surface: om = -lambda e, and d(om)/dt = -lambda om.
        let m = Measurement {
            load_position_rad: -0.2,
            load_velocity_rad_s: 0.5,
            motor_velocity_rad_s: 1.5,
            twist_rad: -0.2,
            ..Measurement::default()
        };
        let transmitted_nm = (16.0 * 0.5 - 7.5 * 2.5 * 0.5) / 3.0;
        let wanted_rad = transmitted_nm - 0.16;
        let want = transmitted_nm + 4.3e-4 * 1.5 - (-0.2 - wanted_rad);
        let ControlOutput { torque_nm, signals } = law.step(&m);
        assert!((torque_nm - want).abs() < 1e-5, "have {torque_nm} N m, want {want}");
        assert!(signals.surface_rad_s.abs() < 1e-6);
    }
}
