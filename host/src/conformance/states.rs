//! Sequences of requests that lead into each state of a drive.

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, EmergencyStop, Reset, Start};

use super::assertion::{Failure, RuleResult, equal};
use super::client::Client;

/// Long enough for any bench on any machine, so that no watchdog trips in a check of another rule.
const LONG_WATCHDOG_US: u32 = 30_000_000;

impl Client {
    /// Resets the drive from any state.
    pub(super) fn reset(&mut self) -> RuleResult {
        // Discards late answers to the previous check, and ends its partial frame.
        self.line.clear().map_err(Failure::Session)?;
        let got = self.command(Reset {})?;
        equal("before the check, Reset", (Outcome::Accepted, State::Boot), got)
    }

    /// Opens the session of this run.
    pub(super) fn idle(&mut self) -> RuleResult {
        let identity = self.handshake(self.session)?;
        equal("after the handshake, state", State::Idle, identity.state)
    }

    pub(super) fn armed(&mut self) -> RuleResult {
        self.idle()?;
        self.arm()
    }

    pub(super) fn arm(&mut self) -> RuleResult {
        let got = self.command(Arm { session: self.session })?;
        equal("Arm in Idle", (Outcome::Accepted, State::Armed), got)
    }

    pub(super) fn start(&mut self) -> RuleResult {
        let got = self.command(Start { session: self.session })?;
        equal("Start in Armed", (Outcome::Accepted, State::Running), got)
    }

    /// Opens the session, sets these parameters, arms and starts.
    pub(super) fn running(&mut self, settings: &[(&str, ParameterValue)]) -> RuleResult {
        self.idle()?;
        self.put("watchdog_us", ParameterValue::U32(LONG_WATCHDOG_US))?;
        self.put_all(settings)?;
        self.arm()?;
        self.start()
    }

    pub(super) fn faulted(&mut self) -> RuleResult {
        self.idle()?;
        let got = self.command(EmergencyStop {})?;
        equal("EmergencyStop", (Outcome::Accepted, State::Faulted), got)
    }

    /// Brings a drive from `Boot` into this state.
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
