//! Everything between a controller's request and the motor, in one place.
//!
//! | rule | reaction |
//! |---|---|
//! | disarmed at boot; `Arm`, then `Start`, of the present session | torque is zero in every other state |
//! | no new sample for `watchdog_us` while running | fault `Watchdog`, see `watchdog` |
//! | encoder faster than `motor_speed_limit_rad_s` / `load_speed_limit_rad_s` | fault, before the controller steps |
//! | reference or torque not finite | fault |
//! | torque beyond `torque_limit_nm` | clamped and flagged |
//! | `EmergencyStop` | fault |
//! | bench mode: fault of the power stage, lost encoder, missing or late tick | fault, see `pin_run` |
//! | bench mode: travel, stall, overload, missing torque, limit switch | fault, see `guard` |
//! | bench mode: torque faster than `torque_slew_nm_s` | slowed down |
//! | bench mode: motor that runs away from its torque | fault, see `motor_direction` |
//! | bench mode: implausible encoder or fault of the power stage before the start | not armed, see `pins` |
//!
//! A fault sets the torque to zero at once and stays latched until `ClearFault`. Time is device time.

use lashloop_protocol::enums::FaultCode;

use crate::law::{DriveParameters, Real};

/// A broken rule: what a fault report carries besides the sequence number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Violation {
    pub(super) code: FaultCode,
    pub(super) value: f32,
    pub(super) limit: f32,
    pub(super) detail: u32,
}

impl Violation {
    /// A violation without value, limit and detail.
    pub(super) fn of(code: FaultCode) -> Self {
        Self { code, value: 0.0, limit: 0.0, detail: 0 }
    }

    /// Whether the rule is one of those that are checked before the controller steps.
    pub(super) fn precedes_law(&self) -> bool {
        use FaultCode::{LoadEncoderJump, MotorEncoderJump, ReferenceNotFinite};
        matches!(self.code, ReferenceNotFinite | MotorEncoderJump | LoadEncoderJump)
    }
}

/// Limits of one run, fixed at its start.
pub(super) struct Limits {
    torque_nm: f32,
    motor_speed_rad_s: f32,
    load_speed_rad_s: f32,
}

impl Limits {
    pub(super) fn new(parameters: &DriveParameters) -> Self {
        Self {
            torque_nm: parameters.torque_limit_nm,
            motor_speed_rad_s: parameters.motor_speed_limit_rad_s,
            load_speed_rad_s: parameters.load_speed_limit_rad_s,
        }
    }

    /// An encoder faster than the mechanics is broken, unplugged or miscounted.
    pub(super) fn check_speeds(&self, motor_rad_s: f32, load_rad_s: f32) -> Result<(), Violation> {
        let (motor_limit, load_limit) = (self.motor_speed_rad_s, self.load_speed_rad_s);
        // NaN is not within a limit.
        holds(motor_rad_s <= motor_limit, FaultCode::MotorEncoderJump, motor_rad_s, motor_limit)?;
        holds(load_rad_s <= load_limit, FaultCode::LoadEncoderJump, load_rad_s, load_limit)
    }

    pub(super) fn check_reference(reference_rad: f32) -> Result<(), Violation> {
        holds(reference_rad.is_finite(), FaultCode::ReferenceNotFinite, reference_rad, 0.0)
    }

    /// The only way to a torque: finite and clamped.
    pub(super) fn clamp_torque(&self, requested_nm: f32) -> Result<f32, Violation> {
        holds(requested_nm.is_finite(), FaultCode::TorqueNotFinite, requested_nm, self.torque_nm)?;
        // `Real`'s clamp: the one of core panics with its bounds and links 12 KiB of float formatting.
        Ok(Real::clamp(requested_nm, -self.torque_nm, self.torque_nm))
    }
}

fn holds(rule: bool, code: FaultCode, value: f32, limit: f32) -> Result<(), Violation> {
    if rule { Ok(()) } else { Err(Violation { value, limit, ..Violation::of(code) }) }
}
