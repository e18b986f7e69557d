//! One run, from `Start` to its end.

use core::time::Duration;

use lashloop_protocol::enums::{State, TorqueFlags, TorqueStatus};
use lashloop_protocol::limits::MAX_SIGNALS;
use lashloop_protocol::message::{BenchSample, EncoderSample, Reference, TorqueAnswer};

use super::bench_sample::bench_sample;
use super::clock::Clock;
use super::control_loop::{Applied, ControlLoop};
use super::pin_run::PinRun;
use super::pins::PinReadings;
use super::safety::{Limits, Violation};
use super::torque_answer::{repeated, torque_answer};
use super::watchdog::Watchdog;
use crate::law::{DriveParameters, LawSet};

pub(super) struct Run<L: LawSet> {
    control: ControlLoop<L>,
    limits: Limits,
    watchdog: Watchdog,
    /// The held torque in N m.
    torque_nm: f32,
    source: Source,
}

/// Where the samples come from.
#[expect(clippy::large_enum_variant, reason = "a drive has one run, and no heap")]
pub(super) enum Source {
    /// From the host, each with an answer.
    Link {
        /// The answer to the last sample.
        last_answer: Option<TorqueAnswer>,
    },
    /// From the encoders of the drive, one for each tick.
    Pins(PinRun),
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
    /// The samples of this run come from the pins.
    OfPins,
}

/// What a tick of a running drive gives.
pub(super) struct PinStep {
    /// The step, unless the fault came before it; zero torque with a fault.
    pub(super) sample: Option<BenchSample>,
    /// Whether the host receives the sample without a fault.
    pub(super) is_reported: bool,
    pub(super) fault: Option<Violation>,
}

impl<L: LawSet> Run<L> {
    pub(super) fn new(
        control: ControlLoop<L>,
        parameters: &DriveParameters,
        source: Source,
        now: Duration,
    ) -> Self {
        let watchdog = Watchdog::start(parameters.watchdog_us, now);
        Self { control, limits: Limits::new(parameters), watchdog, torque_nm: 0.0, source }
    }

    /// The held torque in N m.
    pub(super) fn torque_nm(&self) -> f32 {
        self.torque_nm
    }

    /// Speed of the motor at the last step in rad/s.
    pub(super) fn motor_speed_rad_s(&self) -> f32 {
        self.control.motor_speed_rad_s()
    }

    /// The values of all signals at the last step, by their indices.
    pub(super) fn signals(&self) -> [f32; MAX_SIGNALS] {
        self.control.signals()
    }

    /// The control loop, for a live parameter.
    pub(super) fn control(&mut self) -> &mut ControlLoop<L> {
        &mut self.control
    }

    pub(super) fn watchdog(&self) -> &Watchdog {
        &self.watchdog
    }

    /// The pins of a run in bench mode.
    pub(super) fn pins(&self) -> Option<&PinRun> {
        match &self.source {
            Source::Link { .. } => None,
            Source::Pins(pins) => Some(pins),
        }
    }

    pub(super) fn check_watchdog(&self, now: Duration) -> Result<(), Violation> {
        self.watchdog.check(now)
    }

    /// Checks what has to come in time: samples or references, and the ticks of bench mode.
    pub(super) fn check_time(&self, now: Duration) -> Result<(), Violation> {
        self.check_watchdog(now)?;
        self.pins().map_or(Ok(()), |pins| pins.check_silence(now))
    }

    /// Takes a reference and restarts the watchdog; `false` if the samples come from the host.
    pub(super) fn take_reference(&mut self, reference: Reference, arrived: Duration) -> bool {
        let Source::Pins(pins) = &mut self.source else { return false };
        pins.take_reference(reference);
        self.watchdog.restart(arrived);
        true
    }

    /// Takes the readings of the tick that was due at `due`; `None` if no step is to be made.
    pub(super) fn tick(
        &mut self,
        readings: &PinReadings,
        due: Duration,
        clock: &impl Clock,
    ) -> Option<PinStep> {
        let started = clock.now();
        let Source::Pins(pins) = &mut self.source else { return None };
        let sample = match pins.sample(readings, due) {
            Ok(sample) => sample?,
            Err(violation) => {
                return Some(PinStep { sample: None, is_reported: false, fault: Some(violation) });
            }
        };
        // The law gets the torque that was.
        let held_nm = readings.torque_nm.unwrap_or(self.torque_nm);
        let commanded_nm = self.torque_nm;
        let applied = Applied { torque_nm: held_nm, voltage_v: readings.bridge_voltage_v };
        let torque = self.step(&sample, 1, applied);
        let Source::Pins(pins) = &mut self.source else { return None };
        let now = clock.now();
        let torque = torque.and_then(|(clamped_nm, requested_nm)| {
            let torque_nm = pins.slow_down(clamped_nm, commanded_nm);
            let mut flags = TorqueFlags::empty();
            flags.set(TorqueFlags::SATURATED, clamped_nm != requested_nm && torque_nm == clamped_nm);
            self.torque_nm = torque_nm;
            pins.check_limits(self.control.counts(), readings, [commanded_nm, held_nm, torque_nm])?;
            if !self.control.takes_torque() {
                pins.check_direction(&sample, held_nm)?;
            }
            pins.check_twist(&sample, self.control.twist_rad())?;
            pins.check_end(due, now)?;
            Ok((torque_nm, flags))
        });
        let (torque_nm, flags, fault) = match torque {
            Ok((torque_nm, flags)) => (torque_nm, flags, None),
            Err(violation) => (0.0, TorqueFlags::empty(), Some(violation)),
        };
        let state = if fault.is_some() { State::Faulted } else { State::Running };
        let status = TorqueStatus { state, flags };
        let times = (due, started, now);
        let report = bench_sample(&sample, pins.reference_number(), torque_nm, status, times);
        Some(PinStep { sample: Some(report), is_reported: pins.is_reported(), fault })
    }

    /// Answers a sample; a new one makes a control step and restarts the watchdog.
    pub(super) fn answer(&mut self, sample: &EncoderSample, arrived: Duration, clock: &impl Clock) -> Reply {
        let &Source::Link { last_answer } = &self.source else { return Reply::OfPins };
        let periods = match self.periods_since(last_answer, sample.sequence) {
            Ok(periods) => periods,
            Err(reply) => return reply,
        };
        self.watchdog.restart(arrived);
        let mut flags = TorqueFlags::empty();
        flags.set(TorqueFlags::GAP, periods > 1);
        let applied = Applied { torque_nm: self.torque_nm, voltage_v: 0.0 };
        match self.step(sample, periods, applied) {
            Ok((torque_nm, requested_nm)) => {
                flags.set(TorqueFlags::SATURATED, torque_nm != requested_nm);
                let elapsed = clock.now().saturating_sub(arrived);
                let answer = torque_answer(sample.sequence, torque_nm, State::Running, flags, elapsed);
                self.source = Source::Link { last_answer: Some(answer) };
                Reply::Torque(answer)
            }
            Err(violation) => Reply::Violation(violation, flags),
        }
    }

    /// Periods from the last sample to this one, 1 for the first sample; the reply to a sample that isn't new.
    fn periods_since(&self, last_answer: Option<TorqueAnswer>, sequence: u16) -> Result<u32, Reply> {
        match last_answer {
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
    fn step(
        &mut self,
        sample: &EncoderSample,
        periods: u32,
        applied: Applied,
    ) -> Result<(f32, f32), Violation> {
        Limits::check_reference(sample.reference_rad)?;
        let (motor_rad_s, load_rad_s) = self.control.speeds(sample, periods);
        self.limits.check_speeds(motor_rad_s, load_rad_s)?;
        let requested_nm = self.control.step(sample, periods, applied);
        self.torque_nm = self.limits.clamp_torque(requested_nm)?;
        Ok((self.torque_nm, requested_nm))
    }
}
