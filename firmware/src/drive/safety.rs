//! Everything that stands between a controller's opinion and the motor, in one place.
//!
//! | rule | reaction |
//! |---|---|
//! | disarmed at boot; `Arm`, then `Start`, of the present session | torque is zero in every other state |
//! | no new sample for `watchdog_us` while running | fault `Watchdog` |
//! | encoder faster than `motor_speed_limit_rad_s` / `load_speed_limit_rad_s` | fault, before the controller sees it |
//! | reference or torque not finite | fault |
//! | torque beyond `torque_limit_nm` | limited, and flagged |
//! | `EmergencyStop` | fault |
//!
//! A fault sets the torque to zero at once and stays until `ClearFault`. Time is device time.

use core::time::Duration;

use lashloop_protocol::enums::{FaultCode, Outcome, State};
use lashloop_protocol::message::FaultReport;

use super::parameters::Parameters;
use crate::control::Real;

pub(super) struct Safety {
    state: State,
    fault: Option<FaultReport>,
    torque_nm: f32,
    limits: Limits,
    last_sample_at: Duration,
    last_sequence: Option<u16>,
}

#[derive(Default)]
struct Limits {
    torque_nm: f32,
    motor_speed_rad_s: f32,
    load_speed_rad_s: f32,
    watchdog: Duration,
}

impl Safety {
    pub(super) fn new() -> Self {
        Self {
            state: State::Boot,
            fault: None,
            torque_nm: 0.0,
            limits: Limits::default(),
            last_sample_at: Duration::ZERO,
            last_sequence: None,
        }
    }

    pub(super) fn state(&self) -> State {
        self.state
    }

    pub(super) fn fault(&self) -> Option<FaultReport> {
        self.fault
    }

    pub(super) fn torque_nm(&self) -> f32 {
        self.torque_nm
    }

    pub(super) fn last_sequence(&self) -> Option<u16> {
        self.last_sequence
    }

    /// `Boot` ends; a running drive is disarmed; a latched fault stays.
    pub(super) fn greet(&mut self) {
        if self.state != State::Faulted {
            self.rest(State::Idle);
        }
    }

    pub(super) fn arm(&mut self) -> Outcome {
        self.advance(State::Idle, State::Armed)
    }

    pub(super) fn start(&mut self, parameters: &Parameters, now: Duration) -> Outcome {
        let outcome = self.advance(State::Armed, State::Running);
        if outcome == Outcome::Accepted {
            self.limits = Limits {
                torque_nm: parameters.torque_limit_nm,
                motor_speed_rad_s: parameters.motor_speed_limit_rad_s,
                load_speed_rad_s: parameters.load_speed_limit_rad_s,
                watchdog: Duration::from_micros(parameters.watchdog_us.into()),
            };
            self.last_sample_at = now;
            self.last_sequence = None;
        }
        outcome
    }

    /// Ends armed and running; where there is nothing to end nothing is wrong. A latched fault stays.
    pub(super) fn stop(&mut self) -> Outcome {
        match self.state {
            State::Boot | State::Faulted => return Outcome::WrongState,
            State::Idle | State::Armed | State::Running => self.rest(State::Idle),
        }
        Outcome::Accepted
    }

    /// Back to where a greeted drive rests, or to `Boot` if no host has greeted it yet.
    pub(super) fn clear_fault(&mut self, greeted: bool) -> Outcome {
        let outcome = self.advance(State::Faulted, if greeted { State::Idle } else { State::Boot });
        if outcome == Outcome::Accepted {
            self.fault = None;
        }
        outcome
    }

    /// The first fault is kept until it is cleared: what comes after it is usually its consequence.
    pub(super) fn latch(&mut self, fault: FaultReport) {
        self.rest(State::Faulted);
        self.fault.get_or_insert(fault);
    }

    /// Running, but nobody to ask for a torque.
    pub(super) fn no_controller(&self) -> FaultReport {
        self.report(FaultCode::TorqueNotFinite, f32::NAN, self.limits.torque_nm)
    }

    pub(super) fn emergency_stop(&self) -> FaultReport {
        self.report(FaultCode::EmergencyStop, 0.0, 0.0)
    }

    /// Device time after which a running drive trips without a new sample.
    pub(super) fn watchdog_deadline(&self) -> Option<Duration> {
        (self.state == State::Running).then(|| self.last_sample_at + self.limits.watchdog)
    }

    /// Without a new sample in time the host is gone or blind.
    pub(super) fn check_watchdog(&self, now: Duration) -> Result<(), FaultReport> {
        let silence = now.saturating_sub(self.last_sample_at);
        if self.state == State::Running && silence > self.limits.watchdog {
            let limit = self.limits.watchdog.as_secs_f32();
            return Err(self.report(FaultCode::Watchdog, silence.as_secs_f32(), limit));
        }
        Ok(())
    }

    /// A new sample has come in time; the watchdog starts anew.
    pub(super) fn note_sample(&mut self, sequence: u16, now: Duration) {
        self.last_sequence = Some(sequence);
        self.last_sample_at = now;
    }

    /// An encoder that is faster than the mechanics can be is broken, unplugged or miscounted.
    pub(super) fn check_speeds(&self, motor_rad_s: f32, load_rad_s: f32) -> Result<(), FaultReport> {
        let check = |code, speed_rad_s: f32, limit: f32| {
            // Written so that NaN does not pass.
            if speed_rad_s <= limit { Ok(()) } else { Err(self.report(code, speed_rad_s, limit)) }
        };
        check(FaultCode::MotorEncoderJump, motor_rad_s, self.limits.motor_speed_rad_s)?;
        check(FaultCode::LoadEncoderJump, load_rad_s, self.limits.load_speed_rad_s)
    }

    pub(super) fn check_reference(&self, reference_rad: f32) -> Result<(), FaultReport> {
        if reference_rad.is_finite() {
            Ok(())
        } else {
            Err(self.report(FaultCode::ReferenceNotFinite, reference_rad, 0.0))
        }
    }

    /// The only way to a torque: finite, limited. Returns it with whether it was limited.
    pub(super) fn allow(&mut self, requested_nm: f32) -> Result<(f32, bool), FaultReport> {
        if !requested_nm.is_finite() {
            return Err(self.report(FaultCode::TorqueNotFinite, requested_nm, self.limits.torque_nm));
        }
        // `Real`'s clamp, because core's would print its bounds in a panic and bring 12 KiB of float formatting with it.
        let limit = self.limits.torque_nm;
        self.torque_nm = Real::clamp(requested_nm, -limit, limit);
        Ok((self.torque_nm, self.torque_nm != requested_nm))
    }

    fn advance(&mut self, from: State, to: State) -> Outcome {
        if self.state != from {
            return Outcome::WrongState;
        }
        self.state = to;
        Outcome::Accepted
    }

    fn rest(&mut self, state: State) {
        self.torque_nm = 0.0;
        self.state = state;
    }

    fn report(&self, code: FaultCode, value: f32, limit: f32) -> FaultReport {
        FaultReport { code, sequence: self.last_sequence.unwrap_or(0), value, limit, detail: 0 }
    }
}
