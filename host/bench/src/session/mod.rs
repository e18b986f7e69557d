//! The conversation with a drive: greeting, parameters, commands, and the exchange of a sample for a torque.
//!
//! The session knows messages and deadlines, not plants or scenarios. Every wait ends, and every error says which side,
//! the last sample sent and the last good frame received.

mod at_step;
mod error;
mod exchange;
pub mod greeting;
pub mod line;
mod logs;
pub mod parameters;

use std::time::{Duration, Instant};

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{
    Arm, ClearFault, EmergencyStop, EncoderSample, FaultReport, Identity, LineReport, Reset, Start, Stop,
    Telemetry,
};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

pub use at_step::AtStep;
pub use error::{LastSeen, SessionError};
pub use exchange::Exchange;
pub use parameters::{Parameter, SetError};

use crate::link::Link;
use crate::timing::Timestamps;
pub use line::printable;
use line::{Answered, Line};

/// How long attempts to start a drive may take, one after the other. A line that is slow rather than lossy needs the longer
/// ones.
const START_LIMITS: [Duration; 3] =
    [Duration::from_millis(500), Duration::from_secs(1), Duration::from_secs(2)];

/// Frames out and in, as this side counts them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Frames sent.
    pub frames_sent: u64,
    /// Good frames received.
    pub frames_received: u64,
    /// Frames received damaged.
    pub damaged: u64,
    /// Answers that came after their sample had been given up.
    pub late: u64,
}

/// An open conversation.
pub struct Session {
    line: Line,
    number: u32,
    identity: Identity,
    parameters: Vec<Parameter>,
    late: u64,
    /// The sample that was answered last.
    answered: Option<u16>,
    timestamps: Timestamps,
}

impl Session {
    /// Opens a conversation on a fresh link: clears the line, greets, learns the parameters. `number` tells this session
    /// from earlier ones.
    ///
    /// # Errors
    /// Nobody answers, what answers speaks another version, or the line breaks.
    pub fn open(link: Box<dyn Link>, number: u32) -> Result<Self, SessionError> {
        let mut line = Line::new(link);
        line.clear()?;
        let identity = greeting::greet(&mut line, number)?;
        let parameters = parameters::learn(&mut line, identity.parameter_count)?;
        let now = Instant::now();
        let timestamps = Timestamps { asked: now, sent: now, arrived: now, decoded: now };
        Ok(Self { line, number, identity, parameters, late: 0, answered: None, timestamps })
    }

    /// Who the drive said it is, at the greeting.
    #[must_use]
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The last telemetry since the start.
    #[must_use]
    pub fn telemetry(&self) -> Option<&AtStep<Telemetry>> {
        self.line.telemetry.as_ref()
    }

    /// The last fault the drive reported since the start.
    #[must_use]
    pub fn fault(&self) -> Option<AtStep<FaultReport>> {
        self.line.fault
    }

    /// What the drive's end of the line saw of the last run, once it has been stopped.
    #[must_use]
    pub fn line_report(&self) -> Option<&LineReport> {
        self.line.report.as_ref()
    }

    /// What the drive had to say in words, since it was last asked for.
    pub fn take_logs(&mut self) -> Vec<String> {
        self.line.logs.take()
    }

    /// Frames and what became of them.
    #[must_use]
    pub fn traffic(&self) -> Traffic {
        let counters = self.line.decoder().counters();
        Traffic {
            frames_sent: self.line.frames_sent,
            frames_received: counters.messages.into(),
            damaged: counters.damaged().into(),
            late: self.late,
        }
    }

    /// The error for a drive that has not answered for `limit`.
    #[must_use]
    pub fn silent(&self, limit: Duration) -> SessionError {
        self.line.silent(EncoderSample::LAYOUT.name, limit)
    }

    /// Puts the drive into the state it has after power-up, default parameters and no fault, and greets it again, as a new
    /// session: what an earlier run has left on the line can neither arm nor start this one.
    ///
    /// # Errors
    /// The drive does not answer, or the line broke.
    pub fn reset(&mut self) -> Result<(), SessionError> {
        if let Some(fault) = self.line.fault.take() {
            self.line.logs.note(format!("it came with a latched fault, now cleared: {:?}", fault.code));
        }
        self.command(Reset {}, State::Boot)?;
        self.forget_run();
        self.number = self.number.wrapping_add(1);
        self.identity = greeting::greet(&mut self.line, self.number)?;
        Ok(())
    }

    /// Makes the drive start anew as a moment without power would: it is told, and nobody waits for what it says.
    ///
    /// # Errors
    /// The line broke.
    pub fn reset_by_surprise(&mut self) -> Result<(), SessionError> {
        self.line.send(&Reset {}.into())
    }

    /// Opens the line again if it is gone, and clears it.
    ///
    /// # Errors
    /// It is still gone.
    pub fn clear_line(&mut self) -> Result<(), SessionError> {
        self.line.clear()
    }

    /// Arms and starts.
    ///
    /// # Errors
    /// The drive refused, or the line broke.
    pub fn start(&mut self) -> Result<(), SessionError> {
        self.arm_and_start()?;
        self.forget_run();
        Ok(())
    }

    /// What the drive says from here on is about another run, or about none.
    fn forget_run(&mut self) {
        (self.line.telemetry, self.line.fault, self.line.report) = (None, None, None);
        self.answered = None;
        (self.line.last_seen.sample_sent, self.line.last_seen.torque) = (None, None);
    }

    fn arm_and_start(&mut self) -> Result<(), SessionError> {
        let session = self.number;
        for limit in START_LIMITS {
            self.command(Arm { session }, State::Armed)?;
            let said_before = self.line.logs.mark();
            match self.line.attempt(&Start { session }.into(), limit, result_of::<Start>)? {
                Some((Outcome::Accepted, _)) => return Ok(()),
                Some((outcome, state)) => return Err(self.refused::<Start>(outcome, state, said_before)),
                // It may have started, and then its watchdog is about to trip. A start can't be made up for.
                None => self.disarm()?,
            }
        }
        Err(self.line.silent(Start::LAYOUT.name, START_LIMITS.iter().sum()))
    }

    /// Brings a drive that is armed, runs or has just latched a fault back to where it can be armed.
    ///
    /// # Errors
    /// The drive refused, or the line broke.
    pub fn disarm(&mut self) -> Result<(), SessionError> {
        let said_before = self.line.logs.mark();
        match self.ask(Stop {})?.with {
            (Outcome::Accepted, _) => Ok(()),
            (_, State::Faulted) => self.command(ClearFault {}, State::Idle),
            (outcome, state) => Err(self.refused::<Stop>(outcome, state, said_before)),
        }
    }

    /// Ends whatever the line has left of a frame in the drive's decoder, so that the next request is read.
    ///
    /// # Errors
    /// The line broke.
    pub fn end_frame(&mut self) -> Result<(), SessionError> {
        self.line.end_frame()
    }

    /// Ends the run in good order. A drive that has latched a fault needs no stop.
    ///
    /// # Errors
    /// The line broke, or the drive did not answer.
    pub fn stop(&mut self) -> Result<(), SessionError> {
        let said_before = self.line.logs.mark();
        let mut answer = self.ask(Stop {})?.with;
        if self.line.report.is_none() && answer.0 == Outcome::Accepted {
            // The report comes before the answer. What the line had left of a frame has swallowed it; it is said again.
            answer = self.ask(Stop {})?.with;
        }
        match answer {
            (Outcome::Accepted, _) | (_, State::Faulted) => Ok(()),
            (outcome, state) => Err(self.refused::<Stop>(outcome, state, said_before)),
        }
    }

    /// Leaves a drive that can't be trusted or is not there any more: asks for an emergency stop and waits for nothing.
    pub fn abandon(&mut self) {
        // The line may be what is broken; then the drive's watchdog does it.
        let _ = self.line.send(&EmergencyStop {}.into());
    }

    /// The timestamps of the last exchange.
    #[must_use]
    pub fn timestamps(&self) -> Timestamps {
        self.timestamps
    }

    /// Leaves the line to itself until a moment; a line that needs no care for that returns at once.
    ///
    /// # Errors
    /// The line broke.
    pub fn idle(&mut self, until: Instant) -> Result<(), SessionError> {
        self.line.idle(until)
    }

    /// Sends a command that has to be accepted and leaves the drive in the state `afterwards`.
    fn command<C: Payload + Into<HostMessage>>(
        &mut self,
        command: C,
        afterwards: State,
    ) -> Result<(), SessionError> {
        let said_before = self.line.logs.mark();
        let Answered { with, repeated } = self.ask(command)?;
        match with {
            (Outcome::Accepted, _) => Ok(()),
            // An earlier attempt has done it, and its answer was lost.
            (Outcome::WrongState, state) if repeated && state == afterwards => Ok(()),
            (outcome, state) => Err(self.refused::<C>(outcome, state, said_before)),
        }
    }

    /// Sends a command until the drive has said what became of it.
    fn ask<C: Payload + Into<HostMessage>>(
        &mut self,
        command: C,
    ) -> Result<Answered<(Outcome, State)>, SessionError> {
        self.line.request(&command.into(), result_of::<C>)
    }

    /// The refusal of a request, with what the drive has said since it was made.
    fn refused<Request: Payload>(&self, outcome: Outcome, state: State, said_before: u64) -> SessionError {
        let said = self.line.logs.since(said_before).join("; ");
        SessionError::Refused {
            request: Request::LAYOUT.name,
            outcome,
            state,
            said,
            last_seen: self.line.last_seen,
        }
    }
}

/// What became of a command, if the message says so.
fn result_of<C: Payload>(message: &DriveMessage) -> Option<(Outcome, State)> {
    match message {
        DriveMessage::CommandResult(result) if result.request == C::LAYOUT.kind => {
            Some((result.outcome, result.state))
        }
        _ => None,
    }
}
