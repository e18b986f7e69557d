//! `switched-gains`: one linear state feedback in contact, another one in the gap.
//!
//! After the switched linear controllers in M. Nordin, P.-O. Gutman, "Controlling mechanical systems with backlash - a
//! survey", Automatica 38 (2002) 1633-1649: in contact the motor controls the load through the shaft; in the gap the load is
//! out of reach, and the motor is moved to the flank that will be needed, slowly enough for a soft landing. Restated from the
//! idea; the survey has no tuned controller for this plant.
//!
//! ```text
//! q       = -(k_p e + k_d (om_s - om_r)) - I           dI/dt = k_i e
//! contact U = q - k_w (om_e - N0 om_s)                 |z| >= j0 on the side of q
//! gap     U = k_g (sgn(q) (j0 + margin) - z) - k_b (om_e - N0 om_s)
//! ```
//!
//! The gap is the nominal one, as in the survey. Deviations: on arrival the integral is unloaded and the feedback of the load
//! stops (module `arrival`); the error is limited to `switched_reach_rad`, or the torque limit would set the speed.

use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

use crate::common::arrival::{Arrival, ArrivalBand, Phase};
use crate::common::integral::Integral;

/// Distance behind the flank at which the motor's way through the gap ends (rad).
const MARGIN_RAD: f32 = 0.05;

lashloop_firmware::parameters! {
    /// Gains of contact and gap.
    pub struct SwitchedGains {
        /// k_p, load error to torque in contact.
        switched_gain_nm_rad: F32 = 15.0 in 0.0..=1e5, "N m/rad";
        /// Largest load error that counts.
        switched_reach_rad: F32 = 0.7 in 1e-3..=1e3, "rad";
        /// k_d, load velocity to torque in contact.
        switched_damping_nm_s_rad: F32 = 5.0 in 0.0..=1e5, "N m s/rad";
        /// k_i, integral of the load error to torque.
        switched_integral_nm_rad_s: F32 = 10.0 in 0.0..=1e5, "N m/rad s";
        /// k_w, velocity of the twist to torque in contact.
        switched_twist_nm_s_rad: F32 = 0.04 in 0.0..=1e3, "N m s/rad";
        /// k_g, distance to the flank to torque in the gap.
        switched_gap_nm_rad: F32 = 1.0 in 0.0..=1e5, "N m/rad";
        /// k_b, velocity of the twist to torque in the gap.
        switched_gap_nm_s_rad: F32 = 0.05 in 0.0..=1e3, "N m s/rad";
    }
}

lashloop_firmware::signals! {
    /// Signals of the law.
    pub struct SwitchedSignals {
        /// One in contact, zero in the gap.
        contact: "",
    }
}

/// The law with its constants and its state.
pub struct SwitchedLaw {
    gains: SwitchedGains,
    model: NominalModel,
    limit_nm: f32,
    integral: Integral,
    arrival: Arrival,
}

impl ControlLaw for SwitchedLaw {
    const NAME: &'static str = "switched-gains";
    type Parameters = (SwitchedGains, ArrivalBand, NominalModel);
    type Signals = SwitchedSignals;

    fn new((gains, band, model): Self::Parameters, drive: &DriveParameters) -> Result<Self, ParameterError> {
        let limit_nm = drive.torque_limit_nm;
        let integral = Integral::new(gains.switched_integral_nm_rad_s, limit_nm, drive.period_s());
        Ok(Self { gains, model, limit_nm, integral, arrival: Arrival::new(band, drive) })
    }

    fn step(&mut self, m: &Measurement<f32>) -> ControlOutput<SwitchedSignals> {
        let (gains, model) = (&self.gains, &self.model);
        let phase = self.arrival.step(m);
        let error_rad = m.load_position_rad - m.reference_position_rad;
        let velocity_rad_s = m.load_velocity_rad_s - m.reference_velocity_rad_s;
        let reach_rad = gains.switched_reach_rad;
        let feedback_nm = -gains.switched_gain_nm_rad * error_rad.clamp(-reach_rad, reach_rad)
            - gains.switched_damping_nm_s_rad * velocity_rad_s;
        let feedback_nm = if phase == Phase::Approaching { feedback_nm } else { 0.0 };
        let load_nm = feedback_nm + self.integral.value;
        let at_limit = load_nm.abs() > self.limit_nm || error_rad.abs() > reach_rad;
        self.integral.step(-error_rad, at_limit, phase);

        let twist_rad_s = m.motor_velocity_rad_s - model.reduction_ratio * m.load_velocity_rad_s;
        let contact = m.twist_rad.abs() >= model.dead_zone_rad && m.twist_rad * load_nm > 0.0;
        let torque_nm = if contact {
            load_nm - gains.switched_twist_nm_s_rad * twist_rad_s
        } else {
            let side = if load_nm == 0.0 { 0.0 } else { 1.0_f32.copysign(load_nm) };
            let flank_rad = side * (model.dead_zone_rad + MARGIN_RAD);
            gains.switched_gap_nm_rad * (flank_rad - m.twist_rad) - gains.switched_gap_nm_s_rad * twist_rad_s
        };
        ControlOutput { torque_nm, signals: SwitchedSignals { contact: contact.into() } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_twist(twist_rad: f32) -> ControlOutput<SwitchedSignals> {
        let mut law = SwitchedLaw::new(Default::default(), &DriveParameters::default()).expect("valid");
        law.step(&Measurement { load_position_rad: -0.1, twist_rad, ..Measurement::default() })
    }

    #[test]
    fn motor_in_the_gap_is_sent_to_the_flank_that_drives_the_load() {
        let ControlOutput { torque_nm, signals } = at_twist(-0.1);
        // The load is behind its reference by 0.1 rad, so the positive flank is needed.
        assert!((torque_nm - (0.16 + 0.05 + 0.1)).abs() < 1e-6, "{torque_nm} N m");
        assert_eq!(signals.contact, 0.0);
    }

    #[test]
    fn load_error_drives_the_load_in_contact() {
        let ControlOutput { torque_nm, signals } = at_twist(0.2);
        assert!((torque_nm - 1.5).abs() < 1e-6, "{torque_nm} N m");
        assert_eq!(signals.contact, 1.0);
    }
}
