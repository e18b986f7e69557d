//! `dead-band-cascade`: proportional position control with a dead band, around a motor velocity loop.
//!
//! After the linear controllers in M. Nordin, P.-O. Gutman, "Controlling mechanical systems with backlash - a survey",
//! Automatica 38 (2002) 1633-1649: the gap is not modelled; a dead band on the position error keeps the loop from a limit
//! cycle, and velocity feedback of the motor damps the shaft. With an integral gain of zero this is a PD controller with a
//! dead band. Restated from the idea; the survey has no tuned controller for this plant.
//!
//! ```text
//! e_b = e - sat(e, band),   om_d = N0 (om_r - sat(lambda e_b, v_max) - k_s om_s)
//! U   = k_v (om_d - om_e) + k_i int(om_d - om_e)
//! ```
//!
//! Deviations: the load velocity damps the load through k_s; on arrival the integral is unloaded (module `arrival`).

use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

use crate::common::arrival::{Arrival, ArrivalBand, Phase};
use crate::common::integral::Integral;

lashloop_firmware::parameters! {
    /// Gains of the cascade.
    pub struct CascadeGains {
        /// lambda, load error to commanded load velocity.
        cascade_rate_1_s: F32 = 2.0 in 0.0..=1e4, "1/s";
        /// v_max, largest commanded load velocity.
        cascade_speed_rad_s: F32 = 1.5 in 0.0..=1e4, "rad/s";
        /// k_s, load velocity to commanded load velocity.
        cascade_damping: F32 = 0.1 in 0.0..=1e3, "";
        /// k_v, motor velocity error to torque.
        cascade_gain_nm_s_rad: F32 = 0.05 in 0.0..=1e4, "N m s/rad";
        /// k_i, integral of the motor velocity error to torque.
        cascade_integral_nm_rad: F32 = 0.5 in 0.0..=1e4, "N m/rad";
    }
}

lashloop_firmware::signals! {
    /// Signals of the cascade.
    pub struct CascadeSignals {
        /// Commanded motor velocity.
        wanted_motor_velocity_rad_s: "rad/s",
    }
}

/// The law with its constants and its state.
pub struct DeadBandCascade {
    gains: CascadeGains,
    band_rad: f32,
    ratio: f32,
    limit_nm: f32,
    integral: Integral,
    arrival: Arrival,
}

impl ControlLaw for DeadBandCascade {
    const NAME: &'static str = "dead-band-cascade";
    type Parameters = (CascadeGains, ArrivalBand);
    type Signals = CascadeSignals;

    fn new((gains, band): Self::Parameters, drive: &DriveParameters) -> Result<Self, ParameterError> {
        let limit_nm = drive.torque_limit_nm;
        Ok(Self {
            gains,
            band_rad: band.arrival_band_rad,
            ratio: drive.reduction_ratio,
            limit_nm,
            integral: Integral::new(gains.cascade_integral_nm_rad, limit_nm, drive.period_s()),
            arrival: Arrival::new(band, drive),
        })
    }

    fn step(&mut self, m: &Measurement<f32>) -> ControlOutput<CascadeSignals> {
        let gains = &self.gains;
        let phase = self.arrival.step(m);
        let error_rad = m.load_position_rad - m.reference_position_rad;
        let beyond_rad = error_rad - error_rad.clamp(-self.band_rad, self.band_rad);
        let approach_rad_s = (gains.cascade_rate_1_s * beyond_rad)
            .clamp(-gains.cascade_speed_rad_s, gains.cascade_speed_rad_s);
        let approach_rad_s = if phase == Phase::Approaching { approach_rad_s } else { 0.0 };
        let load_rad_s =
            m.reference_velocity_rad_s - approach_rad_s - gains.cascade_damping * m.load_velocity_rad_s;
        let wanted_motor_velocity_rad_s = self.ratio * load_rad_s;
        let velocity_error = wanted_motor_velocity_rad_s - m.motor_velocity_rad_s;
        let wanted_nm = gains.cascade_gain_nm_s_rad * velocity_error + self.integral.value;
        let at_limit = wanted_nm.abs() > self.limit_nm && wanted_nm * velocity_error > 0.0;
        self.integral.step(velocity_error, at_limit, phase);
        ControlOutput { torque_nm: wanted_nm, signals: CascadeSignals { wanted_motor_velocity_rad_s } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_inside_the_band_commands_no_torque() {
        let mut law = DeadBandCascade::new(Default::default(), &DriveParameters::default()).expect("valid");
        let mut torque_at = |load_position_rad| {
            law.step(&Measurement { load_position_rad, ..Measurement::default() }).torque_nm
        };
        assert_eq!(torque_at(0.0019), 0.0);
        let outside = torque_at(-0.102);
        // k_v N0 lambda (|e| - band), with nothing integrated yet.
        assert!((outside - 0.05 * 3.0 * 2.0 * 0.1).abs() < 1e-6, "{outside} N m");
    }
}
