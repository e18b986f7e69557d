//! The exchange of a control period: a sample for a torque.

use std::time::Instant;

use lashloop_protocol::enums::{Outcome, State, TorqueFlags};
use lashloop_protocol::message::{EncoderSample, FaultReport, TorqueAnswer};
use lashloop_protocol::sequence::{LONGEST_GAP, of_step};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

use crate::at_step::AtStep;
use crate::client::Session;
use crate::error::SessionError;

/// The outcome of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exchange {
    /// The drive's torque for it.
    Answered(TorqueAnswer),
    /// The drive latched a fault or its firmware panicked before the answer.
    Faulted(AtStep<FaultReport>),
    /// No answer by the deadline.
    Unanswered,
    /// The caller has rejected an answer, to this sample or to an earlier one.
    Rejected,
}

impl Session {
    /// Sends the sample of a control period, counted from the start of the drive, and waits for its torque until the
    /// deadline. The sequence number of `sample` is ignored.
    ///
    /// # Errors
    /// The line broke, or the drive rejected the sample, or it would: it has answered none for longer than [`LONGEST_GAP`].
    pub fn exchange(
        &mut self,
        step: u32,
        sample: &EncoderSample,
        deadline: Instant,
    ) -> Result<Exchange, SessionError> {
        self.exchange_checked(step, sample, deadline, |_| true)
    }

    /// As [`exchange`](Self::exchange). Every torque that arrives, late and repeated ones included, goes through `passes`
    /// first; the wait ends with the first that doesn't pass.
    ///
    /// # Errors
    /// As [`exchange`](Self::exchange).
    pub fn exchange_checked(
        &mut self,
        step: u32,
        sample: &EncoderSample,
        deadline: Instant,
        mut passes: impl FnMut(&TorqueAnswer) -> bool,
    ) -> Result<Exchange, SessionError> {
        if self.gap(step) > LONGEST_GAP.into() {
            // The bench has not read meanwhile, so answers of the drive may still be on the line.
            if let Some(end) = self.read_pending(&mut passes)? {
                return Ok(end);
            }
            let periods = self.gap(step);
            if periods > LONGEST_GAP.into() {
                return Err(SessionError::TooLongAGap { periods, last_seen: self.line.last_seen });
            }
        }
        let sequence = of_step(step);
        self.timestamps.asked = self.line.timestamp();
        self.line.send(&HostMessage::EncoderSample(EncoderSample { sequence, ..*sample }))?;
        self.timestamps.sent = self.line.timestamp();
        self.line.last_seen.sample_sent = Some(step);
        let answered = self.answered;
        let mut late = 0;
        let answer = self.line.answer(0, deadline, |message| match message {
            DriveMessage::TorqueAnswer(answer) if !passes(answer) => Some(Ok(Exchange::Rejected)),
            DriveMessage::TorqueAnswer(answer) if answer.sequence == sequence => {
                Some(Ok(Exchange::Answered(*answer)))
            }
            DriveMessage::TorqueAnswer(answer) => {
                late += u64::from(is_late(answer, answered));
                None
            }
            // No answer will follow: the watchdog has tripped or the firmware has panicked.
            DriveMessage::FaultReport(fault) => {
                Some(Ok(Exchange::Faulted(AtStep::near(step, fault.sequence, *fault))))
            }
            // The line reordered samples, and this rejects an older one: the drive runs on.
            DriveMessage::CommandResult(result)
                if result.request == EncoderSample::LAYOUT.kind
                    && (result.outcome, result.state) == (Outcome::OutOfSequence, State::Running) =>
            {
                None
            }
            DriveMessage::CommandResult(result) if result.request == EncoderSample::LAYOUT.kind => {
                Some(Err(result.into()))
            }
            _ => None,
        })?;
        self.timestamps.arrived = self.line.arrived;
        self.timestamps.decoded = self.line.timestamp();
        self.late += late;
        match answer {
            Some(Ok(exchange)) => {
                if matches!(exchange, Exchange::Answered(_)) {
                    self.answered = Some(sequence);
                }
                Ok(exchange)
            }
            Some(Err(reply)) => Err(self.refused::<EncoderSample>(reply)),
            None => Ok(Exchange::Unanswered),
        }
    }

    /// Control periods from the last sample that the drive has answered, in time or late, to `step`.
    fn gap(&self, step: u32) -> u32 {
        step.saturating_sub(self.line.last_seen.torque.unwrap_or(0))
    }

    /// Reads what has arrived between two exchanges. Returns the fault, if one was reported, or a rejection.
    fn read_pending(
        &mut self,
        passes: &mut impl FnMut(&TorqueAnswer) -> bool,
    ) -> Result<Option<Exchange>, SessionError> {
        let (answered, mut late) = (self.answered, 0);
        let now = self.line.now();
        let end = self.line.answer(0, now, |message| match message {
            DriveMessage::FaultReport(_) => Some(None),
            DriveMessage::TorqueAnswer(answer) if !passes(answer) => Some(Some(Exchange::Rejected)),
            DriveMessage::TorqueAnswer(answer) => {
                late += u64::from(is_late(answer, answered));
                None
            }
            _ => None,
        })?;
        self.late += late;
        Ok(end.and_then(|rejected| rejected.or(self.line.fault.map(Exchange::Faulted))))
    }
}

/// Whether this answers a sample after its deadline. A duplicate of a sample or of an answer does not count.
fn is_late(answer: &TorqueAnswer, answered: Option<u16>) -> bool {
    !answer.status.flags.contains(TorqueFlags::REPEATED) && Some(answer.sequence) != answered
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use lashloop_firmware::Laws;
    use lashloop_link::in_process::InProcess;
    use lashloop_protocol::EncoderCounts;

    use super::*;

    /// A started drive with encoders so coarse that their speed limits the gap nowhere.
    fn started() -> Session {
        let mut session = Session::open(Box::new(InProcess::<Laws>::default()), 1).expect("a drive");
        for parameter in ["motor_counts_per_rev", "load_counts_per_rev"] {
            session.set(parameter, 4096.0).expect("a coarse encoder");
        }
        session.start().expect("a drive that starts");
        session
    }

    fn at(session: &mut Session, step: u32) -> Result<Exchange, SessionError> {
        let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
        let sample = EncoderSample { sequence: 0, motor_counts, load_counts, reference_rad: 0.0 };
        let deadline = session.line.now() + Duration::from_secs(5);
        session.exchange(step, &sample, deadline)
    }

    #[test]
    fn the_longest_gap_is_bridged_and_no_longer_one() {
        let longest = u32::from(LONGEST_GAP);
        let mut session = started();
        for step in [0, 1, 1 + longest, 1 + 2 * longest] {
            let answer = at(&mut session, step);
            assert!(matches!(answer, Ok(Exchange::Answered(_))), "step {step}: {answer:?}");
        }
        let beyond = at(&mut session, 2 + 3 * longest);
        assert!(
            matches!(beyond, Err(SessionError::TooLongAGap { periods, .. }) if periods == longest + 1),
            "{beyond:?}"
        );
    }
}
