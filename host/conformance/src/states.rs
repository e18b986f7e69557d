//! Sequences of requests that lead into each state of a drive.

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, EmergencyStop, Reset, Start};

use super::assertion::{RuleResult, equal, preparation, skip};
use super::client::Client;
use lashloop_protocol::HostMessage;
use lashloop_protocol::parameter_names::TORQUE_LIMIT_NM;
use lashloop_protocol::wire::Payload;

/// Long enough for any bench on any machine, so that no watchdog trips in a check of another rule.
pub(super) const LONG_WATCHDOG_US: u32 = 30_000_000;

impl Client {
    /// Resets the drive from any state.
    pub(super) fn reset(&mut self) -> RuleResult {
        // Discards late answers to the previous check, and ends its partial frame.
        self.forget()?;
        let done = self.prepare(Reset {}, State::Boot);
        self.arrivals.skips_late = false;
        done
    }

    /// Opens the session of this run.
    pub(super) fn idle(&mut self) -> RuleResult {
        let opened = self.handshake(self.session).and_then(|it| equal("state", State::Idle, it.state));
        preparation("Hello", opened)
    }

    pub(super) fn armed(&mut self) -> RuleResult {
        self.long_watchdog()?;
        self.arm()
    }

    pub(super) fn arm(&mut self) -> RuleResult {
        self.prepare(Arm { session: self.session }, State::Armed)
    }

    pub(super) fn start(&mut self) -> RuleResult {
        self.prepare(Start { session: self.session }, State::Running)
    }

    /// Sends a command that leads to `state`, as a preparation.
    fn prepare<Command: Payload + Into<HostMessage>>(
        &mut self,
        command: Command,
        state: State,
    ) -> RuleResult {
        let name = Command::LAYOUT.name;
        let done = self
            .command(command)
            .and_then(|got| equal(&format!("{name}: outcome and state"), (Outcome::Accepted, state), got));
        preparation(name, done)
    }

    /// Opens the session and sets a watchdog that no check of another rule trips, and a torque limit unless the default is one.
    pub(super) fn long_watchdog(&mut self) -> RuleResult {
        self.idle()?;
        self.put("watchdog_us", ParameterValue::U32(LONG_WATCHDOG_US))?;
        let limit = self.parameter(TORQUE_LIMIT_NM)?.clone();
        match limit.default {
            // Without it no law shows a torque.
            ParameterValue::F32(0.0) => self.put(TORQUE_LIMIT_NM, limit.max),
            _ => Ok(()),
        }
    }

    /// Opens the session, sets these parameters, arms and starts.
    pub(super) fn running(&mut self, settings: &[(&str, ParameterValue)]) -> RuleResult {
        self.long_watchdog()?;
        self.put_all(settings)?;
        self.arm()?;
        self.start()
    }

    /// As [`Self::running`]. Skips the check if the drive refuses these settings as inconsistent, as it may.
    pub(super) fn running_if_consistent(&mut self, settings: &[(&str, ParameterValue)]) -> RuleResult {
        self.long_watchdog()?;
        self.put_all(settings)?;
        self.arm_if_consistent()?;
        self.start()
    }

    /// As [`Self::arm`], with settings that a drive may refuse.
    pub(super) fn arm_if_consistent(&mut self) -> RuleResult {
        let armed = self.command(Arm { session: self.session });
        if matches!(armed, Ok((Outcome::Inconsistent, State::Idle))) {
            return skip("not run: the drive refuses the settings of this check as inconsistent");
        }
        let wanted = (Outcome::Accepted, State::Armed);
        preparation("Arm", armed.and_then(|got| equal("Arm: outcome and state", wanted, got)))
    }

    pub(super) fn faulted(&mut self) -> RuleResult {
        self.idle()?;
        self.prepare(EmergencyStop {}, State::Faulted)
    }

    /// Brings a drive from `Boot` into this state.
    pub(super) fn enter(&mut self, state: State) -> RuleResult {
        match state {
            State::Boot | State::Unknown(_) => Ok(()),
            State::Idle => self.idle(),
            State::Armed => self.armed(),
            State::Running => self.running(&[]),
            State::Faulted => self.faulted(),
        }
    }
}
