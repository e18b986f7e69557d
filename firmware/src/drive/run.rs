//! One run, from `Start` to its end.

use core::time::Duration;

use lashloop_protocol::enums::{State, TorqueFlags};
use lashloop_protocol::limits::MAX_SIGNALS;
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};

use super::clock::Clock;
use super::control_loop::ControlLoop;
use super::safety::{Limits, Violation};
use super::torque_answer::{repeated, torque_answer};
use super::watchdog::Watchdog;
use crate::law::{DriveParameters, LawSet};

pub(super) struct Run<L: LawSet> {
    control: ControlLoop<L>,
    limits: Limits,
    watchdog: Watchdog,
    /// The answer to the last sample; its torque is the held torque.
    last_answer: Option<TorqueAnswer>,
}

/// What a running drive replies to a sample.
pub(super) enum Reply {
    /// The torque of a control step.
    Torque(TorqueAnswer),
    /// The answer of the last sample again; no control step was made.
    Repeated(TorqueAnswer),
    /// The number is old, too far ahead, or not zero after the start. Nothing changed.
    OutOfSequence,
    /// The sample breaks a rule. The flags belong to the answer with zero torque.
    Violation(Violation, TorqueFlags),
}

impl<L: LawSet> Run<L> {
    pub(super) fn new(control: ControlLoop<L>, parameters: &DriveParameters, now: Duration) -> Self {
        let watchdog = Watchdog::start(parameters.watchdog_us, now);
        Self { control, limits: Limits::new(parameters), watchdog, last_answer: None }
    }

    /// The held torque in N m.
    pub(super) fn torque_nm(&self) -> f32 {
        self.last_answer.map_or(0.0, |answer| answer.torque_nm)
    }

    /// The values of all signals at the last step, by their indices.
    pub(super) fn signals(&self) -> [f32; MAX_SIGNALS] {
        self.control.signals()
    }

    pub(super) fn watchdog(&self) -> &Watchdog {
        &self.watchdog
    }

    /// Answers a sample; a new one makes a control step and restarts the watchdog.
    pub(super) fn answer(&mut self, sample: &EncoderSample, arrived: Duration, clock: &impl Clock) -> Reply {
        let periods = match self.periods_since_last(sample.sequence) {
            Ok(periods) => periods,
            Err(reply) => return reply,
        };
        self.watchdog.restart(arrived);
        let mut flags = TorqueFlags::empty();
        flags.set(TorqueFlags::GAP, periods > 1);
        match self.step(sample, periods) {
            Ok((torque_nm, requested_nm)) => {
                flags.set(TorqueFlags::SATURATED, torque_nm != requested_nm);
                let elapsed = clock.now().saturating_sub(arrived);
                let answer = torque_answer(sample.sequence, torque_nm, State::Running, flags, elapsed);
                self.last_answer = Some(answer);
                Reply::Torque(answer)
            }
            Err(violation) => Reply::Violation(violation, flags),
        }
    }

    /// Periods from the last sample to this one, 1 for the first sample; the reply to a sample that isn't new.
    fn periods_since_last(&self, sequence: u16) -> Result<u32, Reply> {
        match self.last_answer {
            None if sequence == 0 => Ok(1),
            None => Err(Reply::OutOfSequence),
            Some(answer) => match sequence.wrapping_sub(answer.sequence) {
                0 => Err(Reply::Repeated(repeated(answer))),
                gap if gap <= self.control.longest_gap() => Ok(gap.into()),
                _ => Err(Reply::OutOfSequence),
            },
        }
    }

    /// The torques in N m, after the limit and before it.
    fn step(&mut self, sample: &EncoderSample, periods: u32) -> Result<(f32, f32), Violation> {
        Limits::check_reference(sample.reference_rad)?;
        let (motor_rad_s, load_rad_s) = self.control.speeds(sample, periods);
        self.limits.check_speeds(motor_rad_s, load_rad_s)?;
        let requested_nm = self.control.step(sample, periods, self.torque_nm());
        Ok((self.limits.clamp_torque(requested_nm)?, requested_nm))
    }
}
