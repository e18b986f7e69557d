//! Commands of a session: reset, start, stop.

use std::time::Duration;

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{
    Arm, ClearFault, EmergencyStop, EnterLoader, ForgetParameters, RecallParameters, Reset, Start, Stop,
    StoreParameters,
};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

use crate::client::Session;
use crate::error::SessionError;
use crate::handshake::shake_hands;
use crate::patience::Patience;
use crate::refusal::Reply;
use crate::request::Answered;
use crate::signals::Subscription;
use crate::telemetry_count::TelemetryCount;

/// Timeouts of the attempts to start a drive, in their order. A slow line needs the longer ones.
const START_LIMITS: [Duration; 3] =
    [Duration::from_millis(500), Duration::from_secs(1), Duration::from_secs(2)];

impl Session {
    /// Resets the drive to its state after power-up, with default parameters and no fault, and shakes hands for a new
    /// session: a frame of an earlier run can neither arm nor start the drive.
    ///
    /// # Errors
    /// The drive is silent, or the line broke.
    pub fn reset(&mut self) -> Result<(), SessionError> {
        if let Some(fault) = self.line.fault.take() {
            let name = self.line.name_of(fault.code);
            self.line.logs.note(format!("the reset cleared a latched fault: {name}"));
        }
        self.command(Reset {}, State::Boot)?;
        self.forget_run();
        self.values_set.clear();
        self.is_reset = true;
        self.subscription = Subscription::default();
        self.capture = None;
        self.number = self.number.wrapping_add(1);
        self.identity = shake_hands(&mut self.line, self.number)?;
        Ok(())
    }

    /// Resets the drive as a power failure would: the bench waits for no answer.
    ///
    /// # Errors
    /// The line broke.
    pub fn reset_by_surprise(&mut self) -> Result<(), SessionError> {
        self.line.send(&Reset {}.into())
    }

    /// Arms and starts the drive.
    ///
    /// # Errors
    /// The drive rejected a command or is silent, or the line broke.
    pub fn start(&mut self) -> Result<(), SessionError> {
        self.arm_and_start()?;
        self.forget_run();
        // The end of the run and the next one have their own.
        self.line.patience = Patience::default();
        Ok(())
    }

    /// Messages from here on belong to another run or to none.
    fn forget_run(&mut self) {
        (self.line.telemetry, self.line.fault, self.line.report) = (None, None, None);
        self.damaged_before = self.line.decoder.counters().damaged();
        self.line.telemetry_count = TelemetryCount { every: self.subscription.every, ..Default::default() };
        self.answered = None;
        (self.line.last_seen.sample_sent, self.line.last_seen.torque) = (None, None);
    }

    fn arm_and_start(&mut self) -> Result<(), SessionError> {
        let session = self.number;
        let mut silent = None;
        for limit in START_LIMITS {
            self.command(Arm { session }, State::Armed)?;
            match self.line.attempt(&Start { session }.into(), limit, result_of::<Start>)? {
                Some(Reply { outcome: Outcome::Accepted, .. }) => return Ok(()),
                Some(reply) => return Err(self.refused::<Start>(reply)),
                // The drive may have started, and its watchdog is then about to trip: a late start is of no use.
                None => {
                    silent = Some(self.line.silent(Start::LAYOUT.name, START_LIMITS.iter().sum()));
                    self.disarm()?;
                }
            }
        }
        Err(silent.unwrap_or_else(|| self.line.silent(Start::LAYOUT.name, Duration::ZERO)))
    }

    /// Brings a drive that is armed, runs or has just latched a fault back to `Idle`.
    ///
    /// # Errors
    /// The drive rejected the command or is silent, or the line broke.
    pub fn disarm(&mut self) -> Result<(), SessionError> {
        match self.result(Stop {})?.with {
            Reply { outcome: Outcome::Accepted, .. } => Ok(()),
            Reply { state: State::Faulted, .. } => self.command(ClearFault {}, State::Idle),
            reply => Err(self.refused::<Stop>(reply)),
        }
    }

    /// Stops the run. A drive that has latched a fault needs no stop.
    ///
    /// # Errors
    /// The drive is silent, or the line broke.
    pub fn stop(&mut self) -> Result<(), SessionError> {
        let mut reply = self.result(Stop {})?.with;
        if self.line.report.is_none() && reply.outcome == Outcome::Accepted {
            // The report precedes the answer. A partial frame has swallowed it, so we request it again.
            reply = self.result(Stop {})?.with;
        }
        match reply {
            Reply { outcome: Outcome::Accepted, .. } | Reply { state: State::Faulted, .. } => Ok(()),
            reply => Err(self.refused::<Stop>(reply)),
        }
    }

    /// Ends the firmware of a drive in `Idle`, in favour of the boot loader of its chip. No further request reaches the drive.
    ///
    /// # Errors
    /// The drive has no boot loader, rejected the request for another reason or is silent, or the line broke.
    pub fn enter_loader(&mut self) -> Result<(), SessionError> {
        match self.result(EnterLoader { session: self.number })?.with {
            Reply { outcome: Outcome::Accepted, .. } => Ok(()),
            reply => Err(self.refused::<EnterLoader>(reply)),
        }
    }

    /// Stores the parameters in force of a drive in `Idle`: they become its defaults, those after a reset and after power-up.
    ///
    /// # Errors
    /// The drive stores no parameters, could not write them or is silent, or the line broke.
    pub fn store_parameters(&mut self) -> Result<(), SessionError> {
        self.keep(StoreParameters {})
    }

    /// Sets every parameter of a drive in `Idle` to its default.
    ///
    /// # Errors
    /// As [`Self::store_parameters`].
    pub fn recall_parameters(&mut self) -> Result<(), SessionError> {
        self.keep(RecallParameters {})
    }

    /// Forgets the stored parameters of a drive in `Idle`, and sets every one to the default of the firmware.
    ///
    /// # Errors
    /// As [`Self::store_parameters`].
    pub fn forget_parameters(&mut self) -> Result<(), SessionError> {
        self.keep(ForgetParameters {})
    }

    /// A request after which every parameter has its default.
    fn keep<C: Payload + Into<HostMessage>>(&mut self, request: C) -> Result<(), SessionError> {
        self.command(request, State::Idle)?;
        self.values_set.clear();
        for at in 0..self.parameters.len() {
            self.parameters[at].default = self.get(self.parameters[at].index)?;
        }
        Ok(())
    }

    /// Leaves a drive that is lost or can't be trusted: requests an emergency stop and waits for nothing.
    pub fn abandon(&mut self) {
        // If the line is broken, the drive's watchdog stops the motor.
        let _ = self.line.send(&EmergencyStop {}.into());
    }

    /// Sends a command that the drive must accept and that leaves it in the state `afterwards`.
    fn command<C: Payload + Into<HostMessage>>(
        &mut self,
        command: C,
        afterwards: State,
    ) -> Result<(), SessionError> {
        let Answered { with, repeated } = self.result(command)?;
        match with {
            Reply { outcome: Outcome::Accepted, .. } => Ok(()),
            // An earlier copy was accepted and its answer was lost.
            Reply { outcome: Outcome::WrongState, state, .. } if repeated && state == afterwards => Ok(()),
            reply => Err(self.refused::<C>(reply)),
        }
    }

    /// Sends a command until the drive has answered it.
    pub(crate) fn result<C: Payload + Into<HostMessage>>(
        &mut self,
        command: C,
    ) -> Result<Answered<Reply>, SessionError> {
        self.line.request(&command.into(), result_of::<C>)
    }

    /// The error for a refused request.
    pub(crate) fn refused<Request: Payload>(&mut self, reply: Reply) -> SessionError {
        self.line.refused(Request::LAYOUT.name, reply, &self.parameters, &self.signals)
    }
}

/// The result of a command, if `message` is one.
fn result_of<C: Payload>(message: &DriveMessage) -> Option<Reply> {
    match message {
        DriveMessage::CommandResult(result) if result.request == C::LAYOUT.kind => Some(result.into()),
        _ => None,
    }
}
