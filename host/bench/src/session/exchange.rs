//! A sample for a torque: what is sent in every control period, and what may come for it.

use std::time::Instant;

use lashloop_protocol::enums::{Outcome, State, TorqueFlags};
use lashloop_protocol::message::{EncoderSample, FaultReport, TorqueAnswer};
use lashloop_protocol::sequence::{LONGEST_GAP, of_step};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{AtStep, Session, SessionError};

/// What came of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exchange {
    /// The drive's torque for it.
    Answered(TorqueAnswer),
    /// The drive has latched a fault, or died, without answering it.
    Faulted(AtStep<FaultReport>),
    /// No answer within the time given.
    Unanswered,
}

impl Session {
    /// Sends the sample of a control period, counted from the start, and waits for its torque until the deadline. What the
    /// sample has for a sequence is left out of account.
    ///
    /// # Errors
    /// The line broke, the drive refused the sample, or it would, because it has answered nothing for longer than
    /// [`LONGEST_GAP`].
    pub fn exchange(
        &mut self,
        step: u32,
        sample: &EncoderSample,
        deadline: Instant,
    ) -> Result<Exchange, SessionError> {
        if self.gap(step) > LONGEST_GAP.into() {
            // Nobody has listened meanwhile, so what the drive has said is still on the line.
            if let Some(fault) = self.overheard()? {
                return Ok(Exchange::Faulted(fault));
            }
            let periods = self.gap(step);
            if periods > LONGEST_GAP.into() {
                return Err(SessionError::TooLongAGap { periods, last_seen: self.line.last_seen });
            }
        }
        let sequence = of_step(step);
        self.timestamps.asked = Instant::now();
        self.line.send(&HostMessage::EncoderSample(EncoderSample { sequence, ..*sample }))?;
        self.timestamps.sent = Instant::now();
        self.line.last_seen.sample_sent = Some(step);
        let said_before = self.line.logs.mark();
        let answered = self.answered;
        let mut late = 0;
        let answer = self.line.wait(deadline, |message| match message {
            DriveMessage::TorqueAnswer(answer) if answer.sequence == sequence => {
                Some(Ok(Exchange::Answered(*answer)))
            }
            DriveMessage::TorqueAnswer(answer) => {
                late += u64::from(is_late(answer, answered));
                None
            }
            // It will not answer any more: its watchdog has tripped, or these are its last words.
            DriveMessage::FaultReport(fault) => {
                Some(Ok(Exchange::Faulted(AtStep::near(step, fault.sequence, *fault))))
            }
            // The line brought samples in another order, and this is about an older one: the drive runs on.
            DriveMessage::CommandResult(result)
                if result.request == EncoderSample::LAYOUT.kind
                    && (result.outcome, result.state) == (Outcome::OutOfSequence, State::Running) =>
            {
                None
            }
            DriveMessage::CommandResult(result) if result.request == EncoderSample::LAYOUT.kind => {
                Some(Err((result.outcome, result.state)))
            }
            _ => None,
        })?;
        self.timestamps.arrived = self.line.arrived;
        self.timestamps.decoded = Instant::now();
        self.late += late;
        match answer {
            Some(Ok(exchange)) => {
                if matches!(exchange, Exchange::Answered(_)) {
                    self.answered = Some(sequence);
                }
                Ok(exchange)
            }
            Some(Err((outcome, state))) => Err(self.refused::<EncoderSample>(outcome, state, said_before)),
            None => Ok(Exchange::Unanswered),
        }
    }

    /// Control periods from the last sample that the drive is known to have taken, because it has answered it, in time or
    /// late, to this one.
    fn gap(&self, step: u32) -> u32 {
        step.saturating_sub(self.line.last_seen.torque.unwrap_or(0))
    }

    /// Reads what has arrived while nobody listened. Returns the fault, if it tells of one.
    fn overheard(&mut self) -> Result<Option<AtStep<FaultReport>>, SessionError> {
        let (answered, mut late) = (self.answered, 0);
        let fault = self.line.wait(Instant::now(), |message| match message {
            DriveMessage::FaultReport(_) => Some(()),
            DriveMessage::TorqueAnswer(answer) => {
                late += u64::from(is_late(answer, answered));
                None
            }
            _ => None,
        })?;
        self.late += late;
        Ok(fault.and(self.line.fault))
    }
}

/// Whether this is the answer to a sample that has been given up. It is not if the line doubled a sample, whose answer came
/// in time, or an answer, which has been used.
fn is_late(answer: &TorqueAnswer, answered: Option<u16>) -> bool {
    !answer.status.flags.contains(TorqueFlags::REPEATED) && Some(answer.sequence) != answered
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use lashloop_protocol::EncoderCounts;

    use super::*;
    use crate::link::in_process::InProcess;

    /// A drive that has just been started, with encoders so coarse that no gap is too long for them.
    fn started() -> Session {
        let mut session = Session::open(Box::new(InProcess::default()), 1).expect("a drive");
        for parameter in ["motor_counts_per_rev", "load_counts_per_rev"] {
            session.set(parameter, 4096.0).expect("a coarse encoder");
        }
        session.start().expect("a drive that starts");
        session
    }

    fn at(session: &mut Session, step: u32) -> Result<Exchange, SessionError> {
        let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
        let sample = EncoderSample { sequence: 0, motor_counts, load_counts, reference_rad: 0.0 };
        session.exchange(step, &sample, Instant::now() + Duration::from_secs(5))
    }

    #[test]
    fn a_gap_is_gone_over_as_long_as_a_drive_follows_and_no_longer() {
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
