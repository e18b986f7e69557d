//! A proportional-integral velocity cascade that inverts the gap.
//!
//! The load error requests a load velocity, a PI loop of that velocity requests a transmitted torque C_d, and the motor
//! winds the shaft to the twist that transmits it. In the gap no torque passes, so the twist jumps by the dead-zone
//! amplitude j0 to the other flank when C_d changes its sign:
//!
//! ```text
//! om_d = om_r - sat(lambda e)                        e = theta_s - r
//! C_d  = (f_s om_d + k_v (om_d - om_s) + k_i int(om_d - om_s)) / N0
//! z_d  = C_d / K + j0 sat(C_d / c0)
//! U    = C_d + f_m om_e - K (z - z_d) - d (om_e - N0 om_s)
//! ```

use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

/// Load error to wanted load velocity, lambda (1/s).
const APPROACH_RATE_1_S: f32 = 2.5;
/// Largest wanted load velocity relative to the reference (rad/s).
const APPROACH_SPEED_RAD_S: f32 = 1.5;
/// Transmitted torque within which the motor crosses the gap, c0 (N m).
const GAP_CROSSING_NM: f32 = 0.05;
/// Largest torque of the integral at the load (N m).
const INTEGRAL_LIMIT_NM: f32 = 8.0;
/// Velocity of the twist to torque, d (N m s/rad).
const TWIST_DAMPING_NM_S_RAD: f32 = 0.04;

lashloop_firmware::parameters! {
    /// Gains of the velocity loop.
    pub struct VelocityGains {
        /// k_v, load velocity error to torque at the load.
        velocity_gain_nm_s_rad: F32 = 30.0 in 0.0..=1e4, "N m s/rad";
        /// k_i, integral of the load velocity error to torque at the load.
        velocity_integral_nm_rad: F32 = 60.0 in 0.0..=1e4, "N m/rad";
    }
}

lashloop_firmware::signals! {
    /// Signals of the law.
    pub struct VelocitySignals {
        /// z_d, the twist that transmits the wanted torque.
        wanted_twist_rad: "rad",
    }
}

/// The law with its constants and its state.
pub struct VelocityPi {
    gains: VelocityGains,
    model: NominalModel,
    period_s: f32,
    /// Bound of the transmitted torque: what the motor can hold (N m).
    torque_limit_nm: f32,
    integral_nm: f32,
}

impl ControlLaw for VelocityPi {
    const NAME: &'static str = "velocity-pi";
    // Two parameters of this law, and the nominal mechanics that Lashloop's laws have too.
    type Parameters = (VelocityGains, NominalModel);
    type Signals = VelocitySignals;
    // What the host may set during a run: `update` takes it.
    const LIVE: &'static [&'static str] = &["velocity_gain_nm_s_rad", "velocity_integral_nm_rad"];

    fn new((gains, model): Self::Parameters, drive: &DriveParameters) -> Result<Self, ParameterError> {
        // A held torque reverses the motor within a period if it damps more than the motor's momentum.
        let inertia_over_period = model.motor_inertia_kg_m2 / drive.period_s();
        ParameterError::at_most(
            "period_us",
            TWIST_DAMPING_NM_S_RAD,
            inertia_over_period,
            "motor_inertia_kg_m2 over the control period",
        )?;
        let (period_s, torque_limit_nm) = (drive.period_s(), drive.torque_limit_nm);
        Ok(Self { gains, model, period_s, torque_limit_nm, integral_nm: 0.0 })
    }

    fn update(&mut self, (gains, _): &Self::Parameters) -> Result<(), ParameterError> {
        self.gains = *gains;
        Ok(())
    }

    fn step(&mut self, m: &Measurement<f32>) -> ControlOutput<VelocitySignals> {
        let Self { gains, model, .. } = self;
        let error_rad = m.load_position_rad - m.reference_position_rad;
        let wanted_rad_s =
            m.reference_velocity_rad_s - bounded(APPROACH_RATE_1_S * error_rad, APPROACH_SPEED_RAD_S);
        let velocity_error_rad_s = wanted_rad_s - m.load_velocity_rad_s;
        let at_load_nm = model.load_friction_nm_s_rad * wanted_rad_s
            + gains.velocity_gain_nm_s_rad * velocity_error_rad_s
            + self.integral_nm;
        let requested_nm = at_load_nm / model.reduction_ratio;
        let transmitted_nm = bounded(requested_nm, self.torque_limit_nm);
        // Anti-windup: at the limit the integral is frozen.
        if transmitted_nm == requested_nm {
            let step_nm = gains.velocity_integral_nm_rad * self.period_s * velocity_error_rad_s;
            self.integral_nm = bounded(self.integral_nm + step_nm, INTEGRAL_LIMIT_NM);
        }
        let wanted_twist_rad = transmitted_nm / model.stiffness_nm_rad
            + model.dead_zone_rad * bounded(transmitted_nm / GAP_CROSSING_NM, 1.0);
        let twist_velocity_rad_s = m.motor_velocity_rad_s - model.reduction_ratio * m.load_velocity_rad_s;
        let torque_nm = transmitted_nm + model.motor_friction_nm_s_rad * m.motor_velocity_rad_s
            - model.stiffness_nm_rad * (m.twist_rad - wanted_twist_rad)
            - TWIST_DAMPING_NM_S_RAD * twist_velocity_rad_s;
        ControlOutput { torque_nm, signals: VelocitySignals { wanted_twist_rad } }
    }
}

/// The value within `-limit..=limit`. NaN stays NaN: the drive rejects a torque that is not finite.
fn bounded(value: f32, limit: f32) -> f32 {
    if value > limit {
        limit
    } else if value < -limit {
        -limit
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use lashloop_firmware::law::LawSet;

    use super::*;
    use crate::OwnLaws;

    fn law() -> VelocityPi {
        VelocityPi::new((VelocityGains::default(), NominalModel::default()), &DriveParameters::default())
            .expect("the defaults go together")
    }

    fn at_rest(load_position_rad: f32) -> Measurement<f32> {
        Measurement { load_position_rad, ..Measurement::default() }
    }

    #[test]
    fn no_torque_at_rest_on_the_reference() {
        let output = law().step(&at_rest(0.0));
        assert_eq!((output.torque_nm, output.signals.wanted_twist_rad), (0.0, 0.0));
    }

    #[test]
    fn the_motor_leads_the_wanted_torque_by_the_gap() {
        let output = law().step(&at_rest(-0.1));
        // (f_s + k_v) lambda e / N0, with nothing integrated yet; at 1 N m/rad.
        let wanted_nm = 46.0 * 2.5 * 0.1 / 3.0;
        let twist_rad = wanted_nm + 0.16;
        assert!(
            (output.signals.wanted_twist_rad - twist_rad).abs() < 1e-5,
            "{}",
            output.signals.wanted_twist_rad
        );
        assert!((output.torque_nm - (wanted_nm + twist_rad)).abs() < 1e-5, "{}", output.torque_nm);
    }

    #[test]
    fn a_gain_set_during_a_run_acts_on_the_next_torque() {
        let mut law = law();
        let before = law.step(&at_rest(-0.1)).torque_nm;
        let gains = VelocityGains { velocity_gain_nm_s_rad: 10.0, ..VelocityGains::default() };
        law.update(&(gains, NominalModel::default())).expect("any gains go together");
        assert!(law.step(&at_rest(-0.1)).torque_nm < before);
    }

    #[test]
    fn a_period_too_long_for_the_damping_is_rejected_by_name() {
        let slow = DriveParameters { period_us: 50_000, ..DriveParameters::default() };
        let error = VelocityPi::new((VelocityGains::default(), NominalModel::default()), &slow).err();
        assert_eq!(error.map(|error| error.name), Some("period_us"));
    }

    #[test]
    fn the_drive_describes_the_law_and_what_it_has() {
        assert_eq!(OwnLaws::NAMES[0], "velocity-pi");
        let own: [&str; 2] = ["velocity_gain_nm_s_rad", "velocity_integral_nm_rad"];
        let laws = |name| OwnLaws::PARAMETERS.iter().find(|p| p.name == name).map(|p| p.laws);
        assert_eq!(own.map(laws), [Some(0b00001); 2]);
        assert_eq!(laws("stiffness_nm_rad"), Some(0b11111), "shared with Lashloop's laws");
        assert!(OwnLaws::SIGNALS.iter().any(|signal| signal.name == "wanted_twist_rad"));
        let is_live = |name| OwnLaws::PARAMETERS.iter().any(|p| p.name == name && p.live);
        assert!(own.into_iter().all(is_live) && !is_live("stiffness_nm_rad"));
    }
}
