//! Sequences of requests that lead into each state of a drive.

use super::assertion::{RuleResult, equal, preparation, skip};
use super::client::Client;
use crate::prelude::wire::*;

/// Long enough for any bench on any machine, so that no watchdog trips in a check of another rule.
pub(super) const LONG_WATCHDOG_US: u32 = 30_000_000;

impl Client {
    /// Resets the drive from any state.
    pub(super) fn reset(&mut self) -> RuleResult {
        // Discards late answers to the previous check, and ends its partial frame.
        self.forget()?;
        let done = self.prepare(Reset {}, Boot);
        self.arrivals.skips_late = false;
        done
    }

    /// Opens the session of this run.
    pub(super) fn idle(&mut self) -> RuleResult {
        let opened = self.handshake(self.session).and_then(|it| equal("state", Idle, it.state));
        preparation("Hello", opened)
    }

    pub(super) fn armed(&mut self) -> RuleResult {
        self.long_watchdog()?;
        self.arm()
    }

    pub(super) fn arm(&mut self) -> RuleResult {
        self.prepare(Arm { session: self.session }, Armed)
    }

    pub(super) fn start(&mut self) -> RuleResult {
        self.prepare(Start { session: self.session }, Running)
    }

    pub(super) fn arm_and_start(&mut self) -> RuleResult {
        self.arm()?;
        self.start()
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
            .and_then(|got| equal(&format!("{name}: outcome and state"), (Accepted, state), got));
        preparation(name, done)
    }

    /// Opens the session and sets a watchdog that no check of another rule trips, and a torque limit unless the default is one.
    pub(super) fn long_watchdog(&mut self) -> RuleResult {
        self.idle()?;
        self.put("watchdog_us", U32(LONG_WATCHDOG_US))?;
        let limit = self.parameter(TORQUE_LIMIT_NM)?.clone();
        match limit.default {
            // Without it no law shows a torque.
            F32(0.0) => self.put(TORQUE_LIMIT_NM, limit.max),
            _ => Ok(()),
        }
    }

    /// Opens the session, sets these parameters, arms and starts.
    pub(super) fn running(&mut self, settings: &[(&str, ParameterValue)]) -> RuleResult {
        self.long_watchdog()?;
        self.put_all(settings)?;
        self.arm_and_start()
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
        if matches!(armed, Ok((Inconsistent, Idle))) {
            return skip("not run: the drive refuses the settings of this check as inconsistent");
        }
        let wanted = (Accepted, Armed);
        preparation("Arm", armed.and_then(|got| equal("Arm: outcome and state", wanted, got)))
    }

    pub(super) fn faulted(&mut self) -> RuleResult {
        self.idle()?;
        self.prepare(EmergencyStop {}, Faulted)
    }

    /// Brings a drive from `Boot` into this state.
    pub(super) fn enter(&mut self, state: State) -> RuleResult {
        match state {
            Boot | State::Unknown(_) => Ok(()),
            Idle => self.idle(),
            Armed => self.armed(),
            Running => self.running(&[]),
            Faulted => self.faulted(),
        }
    }

    /// Makes a check in each of these states, from a reset on.
    pub(super) fn in_states(
        &mut self,
        states: &[State],
        check: impl Fn(&mut Self, State) -> RuleResult,
    ) -> RuleResult {
        states.iter().try_for_each(|&state| {
            self.reset()?;
            self.enter(state)?;
            check(self, state)
        })
    }
}
