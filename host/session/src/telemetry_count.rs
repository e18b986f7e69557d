//! Telemetry that is due, received and refused in a run.

use lashloop_protocol::enums::{State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::Telemetry;
use lashloop_protocol::wire::{BodyError, Payload};
use lashloop_protocol::{DriveMessage, FrameError};

/// Counts of a run. Every torque of a running drive whose sequence is a multiple of `every` has a telemetry.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TelemetryCount {
    /// Period of the telemetry in samples; 0 for none.
    pub every: u16,
    /// By the torques received.
    pub due: u64,
    /// Good ones.
    pub received: u64,
    /// Whole frames of this kind that the decoder has refused.
    pub refused: u64,
}

impl TelemetryCount {
    #[inline]
    pub(crate) fn note(&mut self, message: &DriveMessage) {
        match message {
            DriveMessage::TorqueAnswer(it) => self.note_step(it.sequence, it.status),
            DriveMessage::BenchSample(it) => self.note_step(it.sequence, it.status),
            DriveMessage::Telemetry(_) => self.received += 1,
            _ => {}
        }
    }

    #[inline]
    fn note_step(&mut self, sequence: u16, status: TorqueStatus) {
        let has_telemetry = self.every != 0 && sequence.is_multiple_of(self.every);
        let is_step = status.state == State::Running && !status.flags.contains(TorqueFlags::REPEATED);
        self.due += u64::from(has_telemetry && is_step);
    }

    pub(crate) fn note_bad(&mut self, error: &FrameError) {
        let FrameError::Body(
            BodyError::Length { name, .. } | BodyError::Elements { name, .. } | BodyError::Value { name, .. },
        ) = error
        else {
            return;
        };
        self.refused += u64::from(*name == Telemetry::LAYOUT.name);
    }

    /// What is missing, as a sentence; `None` if `damaged` frames explain it.
    #[must_use]
    pub fn warning(&self, damaged: u64) -> Option<String> {
        let Self { every, due, received, refused } = *self;
        if received + damaged >= due && refused == 0 {
            return None;
        }
        let refused = match refused {
            0 => String::new(),
            count => format!(", {count} refused for their length"),
        };
        Some(format!("telemetry is missing: {due} due, every {every} samples, {received} received{refused}"))
    }
}

#[cfg(test)]
mod tests {
    use lashloop_protocol::TelemetryValues;
    use lashloop_protocol::message::TorqueAnswer;

    use super::*;

    fn torque(sequence: u16, state: State, flags: TorqueFlags) -> DriveMessage {
        let status = TorqueStatus { state, flags };
        TorqueAnswer { sequence, torque_nm: 0.0, status, compute_tenths_us: 0 }.into()
    }

    #[test]
    fn telemetry_is_due_with_the_steps_that_the_drive_makes() {
        let mut count = TelemetryCount { every: 10, ..TelemetryCount::default() };
        let none = TorqueFlags::empty();
        for message in [
            torque(0, State::Running, none),
            torque(0, State::Running, TorqueFlags::REPEATED),
            torque(9, State::Running, none),
            torque(20, State::Running, TorqueFlags::GAP),
            torque(30, State::Faulted, none),
        ] {
            count.note(&message);
        }
        assert_eq!(count.due, 2);
        let values = TelemetryValues::new(&[1.0]).expect("a value");
        count.note(&Telemetry { sequence: 0, values }.into());
        assert_eq!(count.warning(1), None, "the line has damaged it");
        let missing = "telemetry is missing: 2 due, every 10 samples, 1 received";
        assert_eq!(count.warning(0).as_deref(), Some(missing));
        count.note_bad(&FrameError::Body(BodyError::Elements {
            name: "Telemetry",
            longest: 55,
            step: 4,
            found: 8,
        }));
        assert_eq!(count.warning(1), Some(format!("{missing}, 1 refused for their length")));
    }
}
