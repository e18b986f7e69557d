//! The fault of a drive that ended a run.

use std::fmt;
use std::ops::Deref;

use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::message::FaultReport;
use lashloop_session::AtStep;

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
                write!(out, "the drive latched {code} at sample {step} (value {value}, limit {limit})")
            }
        }
    }
}
