//! The fault of a drive that ended a run.

use std::fmt;
use std::ops::Deref;

use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::message::FaultReport;
use lashloop_protocol::parameter_names::{LOAD_SPEED_LIMIT_RAD_S, MOTOR_SPEED_LIMIT_RAD_S, WATCHDOG_US};
use lashloop_session::AtStep;

use crate::number::{Apart, Shown};

/// The fault of a drive that ended a run.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveFault {
    report: AtStep<FaultReport>,
    /// The drive's own name of a code that this bench doesn't know.
    own_name: Option<String>,
}

impl DriveFault {
    /// The fault with the drive's own name of its code.
    #[must_use]
    pub fn named(self, own_name: Option<String>) -> Self {
        Self { own_name, ..self }
    }
}

impl From<AtStep<FaultReport>> for DriveFault {
    fn from(report: AtStep<FaultReport>) -> Self {
        Self { report, own_name: None }
    }
}

impl Deref for DriveFault {
    type Target = AtStep<FaultReport>;

    fn deref(&self) -> &AtStep<FaultReport> {
        &self.report
    }
}

/// What value and limit of a report are, and what is often behind it.
struct Meaning {
    what: &'static str,
    unit: &'static str,
    /// The parameter that has the limit.
    limit_name: Option<&'static str>,
    cause: &'static str,
}

impl Meaning {
    /// `None` for a code without value and limit.
    fn of(code: FaultCode, detail: u32) -> Option<Self> {
        let (what, unit, limit_name, cause) = match code {
            FaultCode::Watchdog => {
                ("no sample for", "s", Some(WATCHDOG_US), "the bench was late, or the line lost samples")
            }
            FaultCode::MotorEncoderJump => (
                "the motor at",
                "rad/s",
                Some(MOTOR_SPEED_LIMIT_RAD_S),
                "an unstable loop, or an encoder that jumps",
            ),
            FaultCode::LoadEncoderJump => (
                "the load at",
                "rad/s",
                Some(LOAD_SPEED_LIMIT_RAD_S),
                "an unstable loop, or an encoder that jumps",
            ),
            FaultCode::MotorEncoderLost if detail == 0 => {
                ("its encoder stood still while the load moved by", "rad", None, "a wire of the encoder")
            }
            FaultCode::LoadEncoderLost if detail == 0 => {
                ("its encoder stood still while the motor moved by", "rad", None, "a wire of the encoder")
            }
            FaultCode::TickOverrun => ("a control step took", "s", None, ""),
            FaultCode::MotorTravel => ("the motor at", "rad", None, ""),
            FaultCode::LoadTravel => ("the load at", "rad", None, ""),
            FaultCode::Stall => ("at the limit of the torque without a motion for", "s", None, ""),
            FaultCode::Overload if detail == 2 => ("the mean current of the stage was", "A", None, ""),
            FaultCode::Overload => ("the mean torque of the motor was", "N m", None, ""),
            FaultCode::TorqueMissing => ("the torque was below half the command for", "s", None, ""),
            _ => return None,
        };
        Some(Self { what, unit, limit_name, cause })
    }
}

impl fmt::Display for DriveFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let AtStep { step, message: FaultReport { code, value, limit, detail, .. } } = self.report;
        match (code, &self.own_name) {
            (FaultCode::Panic, _) => write!(out, "the firmware panicked, source line {detail}"),
            (FaultCode::ProcessorFault, _) => {
                write!(out, "the processor took a fault at {detail:#010x}, or an interrupt of that number")
            }
            (FaultCode::MotorAgainstTorque, _) => {
                let remedy = match detail {
                    1 => "the load turned with it: reverse torque_direction",
                    2 => "the load turned against it: reverse motor_direction",
                    _ => "the load stood still: reverse torque_direction or motor_direction",
                };
                write!(
                    out,
                    "the motor turned by {value} rad against its torque until sample {step}; {remedy}"
                )
            }
            // What the values of a foreign code mean is known to the drive alone.
            (_, Some(name)) => write!(
                out,
                "the drive latched {name} at sample {step} (value {value}, limit {limit}, detail {detail})"
            ),
            (code, None) => {
                write!(out, "the drive latched {code} at sample {step}")?;
                match Meaning::of(code, detail) {
                    Some(Meaning { what, unit, limit_name, cause }) => {
                        let above = limit_name.map_or_else(String::new, |name| format!("{name}, "));
                        let (factor, unit) = if unit == "s" { (1e3, "ms") } else { (1.0, unit) };
                        let [value, limit] = [value, limit].map(|it| factor * f64::from(it));
                        let (shown, limit) = (Apart::new(value, None, Some(limit)), Shown(limit));
                        write!(out, ": {what} {shown} {unit}, above {above}{limit} {unit}")?;
                        if cause.is_empty() { Ok(()) } else { write!(out, ": {cause}") }
                    }
                    None => write!(out, " (value {value}, limit {limit})"),
                }
            }
        }
    }
}
