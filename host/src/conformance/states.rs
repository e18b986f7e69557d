//! The way of a drive into each of its states.

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::message::{Arm, EmergencyStop, Reset, Start};

use super::assertion::{RuleResult, equal};
use super::client::Client;

/// Long enough for any bench on any machine, so that no watchdog trips in a check of another rule.
const LONG_WATCHDOG_US: u32 = 30_000_000;

impl Client {
    /// Brings the drive to where it is after power-up, whatever the check before has left.
    pub(super) fn reset(&mut self) -> RuleResult {
        // Ends whatever half frame was left.
        self.send_bytes(&[DELIMITER])?;
        let came = self.command(Reset {})?;
        equal("before the check, Reset", (Outcome::Accepted, State::Boot), came)
    }

    /// Greets with the session of this run.
    pub(super) fn idle(&mut self) -> RuleResult {
        let identity = self.handshake(self.session())?;
        equal("after the greeting, state", State::Idle, identity.state)
    }

    pub(super) fn armed(&mut self) -> RuleResult {
        self.idle()?;
        self.arm()
    }

    pub(super) fn arm(&mut self) -> RuleResult {
        let session = self.session();
        let came = self.command(Arm { session })?;
        equal("Arm in Idle", (Outcome::Accepted, State::Armed), came)
    }

    pub(super) fn start(&mut self) -> RuleResult {
        let session = self.session();
        let came = self.command(Start { session })?;
        equal("Start in Armed", (Outcome::Accepted, State::Running), came)
    }

    /// Greets, sets these parameters, arms and starts.
    pub(super) fn running(&mut self, settings: &[(&str, ParameterValue)]) -> RuleResult {
        self.idle()?;
        self.put("watchdog_us", ParameterValue::U32(LONG_WATCHDOG_US))?;
        for (name, value) in settings {
            self.put(name, *value)?;
        }
        self.arm()?;
        self.start()
    }

    pub(super) fn faulted(&mut self) -> RuleResult {
        self.idle()?;
        let came = self.command(EmergencyStop {})?;
        equal("EmergencyStop", (Outcome::Accepted, State::Faulted), came)
    }

    /// Brings a fresh drive into this state.
    pub(super) fn enter(&mut self, state: State) -> RuleResult {
        match state {
            State::Boot => Ok(()),
            State::Idle => self.idle(),
            State::Armed => self.armed(),
            State::Running => self.running(&[]),
            State::Faulted => self.faulted(),
        }
    }
}
