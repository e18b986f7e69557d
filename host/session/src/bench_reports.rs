//! Bench mode: references to the drive, and the reports of its own control steps.

use std::time::Instant;

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{BenchSample, FaultReport, Reference};
use lashloop_protocol::sequence::of_step;
use lashloop_protocol::wire::Payload;

use crate::at_step::AtStep;
use crate::client::Session;
use crate::error::SessionError;
use crate::refusal::Reply;

/// What the drive sends of its own accord while it runs in bench mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BenchReport {
    /// A control step.
    Step(AtStep<BenchSample>),
    /// The drive latched a fault or its firmware panicked.
    Faulted(AtStep<FaultReport>),
    /// The drive runs no more, and why is not known: it refuses references in this state.
    Refused(State),
}

impl Session {
    /// Sends the reference of a period, counted from the start of the drive.
    ///
    /// # Errors
    /// The line broke.
    pub fn send_reference(&mut self, period: u32, reference_rad: f32) -> Result<(), SessionError> {
        self.line.send(&Reference { number: of_step(period), reference_rad }.into())?;
        self.line.last_seen.sample_sent = Some(period);
        Ok(())
    }

    /// Waits for the next report; `None` at the deadline. Steps are counted near to the last reference.
    ///
    /// # Errors
    /// The line broke, or the drive restarted.
    pub fn bench_report(&mut self, deadline: Instant) -> Result<Option<BenchReport>, SessionError> {
        let period = self.line.last_seen.sample_sent.unwrap_or(0);
        let report = self.line.answer(0, deadline, |message| match message {
            DriveMessage::BenchSample(sample) => {
                Some(Ok(BenchReport::Step(AtStep::near(period, sample.sequence, *sample))))
            }
            DriveMessage::FaultReport(fault) => {
                Some(Ok(BenchReport::Faulted(AtStep::near(period, fault.sequence, *fault))))
            }
            DriveMessage::CommandResult(result) if result.request == Reference::LAYOUT.kind => {
                Some(match Reply::from(result) {
                    // The report of the watchdog follows it.
                    Reply { outcome: Outcome::WrongState, state, .. } if state != State::Boot => {
                        Ok(BenchReport::Refused(state))
                    }
                    reply => Err(reply),
                })
            }
            _ => None,
        })?;
        match report {
            Some(Err(reply)) => Err(self.refused::<Reference>(reply)),
            Some(Ok(report)) => Ok(Some(report)),
            None => Ok(None),
        }
    }
}
