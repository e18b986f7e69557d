//! What a history reached; invariants checked in few states prove little.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{FaultCode, Outcome, State};

use crate::invariants::{Observer, Step};

/// What a history reached.
#[derive(Clone, Debug, Default)]
pub struct Coverage {
    /// States entered.
    pub states: Vec<State>,
    /// Faults latched.
    pub faults: Vec<FaultCode>,
    /// Outcomes sent.
    pub outcomes: Vec<Outcome>,
    /// Number of torques other than zero.
    pub torques: usize,
    /// Number of messages of telemetry.
    pub telemetry: usize,
    /// Number of stalls by a full output buffer.
    pub full: usize,
}

impl Observer for Coverage {
    fn step(&mut self, step: &Step<'_>) {
        note(&mut self.states, step.after);
        self.torques += usize::from(step.torque_nm != 0.0);
        for message in step.sent {
            match message {
                DriveMessage::FaultReport(report) => note(&mut self.faults, report.code),
                DriveMessage::ParameterReport(report) => note(&mut self.outcomes, report.outcome),
                DriveMessage::CommandResult(result) => note(&mut self.outcomes, result.outcome),
                DriveMessage::Telemetry(_) => self.telemetry += 1,
                _ => {}
            }
        }
    }

    fn stall(&mut self) {
        self.full += 1;
    }
}

fn note<T: PartialEq>(seen: &mut Vec<T>, value: T) {
    if !seen.contains(&value) {
        seen.push(value);
    }
}
