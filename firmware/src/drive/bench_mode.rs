//! Bench mode: the tick of the drive instead of the host's samples, and a power stage instead of its answers.

use core::time::Duration;

use lashloop_protocol::enums::Outcome;
use lashloop_protocol::message::Reference;
use lashloop_protocol::wire::Payload;

use super::clock::Clock;
use super::lifecycle::Lifecycle;
use super::machine::Drive;
use super::pin_run::PinRun;
use super::pins::PinReadings;
use super::run::{PinStep, Run};
use crate::actuator::StageCommand;
use crate::law::LawSet;
use crate::torque::TorqueSource;

impl<L: LawSet> Drive<L> {
    /// Takes what the pins read at the tick that was due at device time `due`. While the drive runs in bench mode this is a
    /// control step. To be called once in every [`Self::period`], in every state: arming requires plausible readings.
    pub fn sample(&mut self, readings: &PinReadings, due: Duration, clock: &impl Clock) {
        let Some(pins) = &mut self.pins else { return };
        pins.note(readings, due);
        if let Lifecycle::Idle { .. } = &self.lifecycle {
            self.find_home(readings);
        }
        let Lifecycle::Running { run, .. } = &mut self.lifecycle else { return };
        let late = run.pins().and_then(|_| run.check_watchdog(clock.now()).err());
        let step = match late {
            Some(violation) => PinStep { sample: None, is_reported: false, fault: Some(violation) },
            None => match run.tick(readings, due, clock) {
                Some(step) => step,
                None => return,
            },
        };
        let PinStep { sample, is_reported, fault } = step;
        let is_due = |sequence| fault.is_none() && self.subscription.is_due(sequence);
        let signals = sample.filter(|sample| is_due(sample.sequence)).map(|_| run.signals());
        if let Some(sample) = sample {
            self.last_sequence = sample.sequence;
            self.scope.step(fault.as_ref(), || run.signals());
        }
        // Before the report of the step, whose torque is zero.
        let fault = fault.map(|violation| self.latch(violation, clock.now()));
        // A report of a step never displaces an answer or a fault report.
        if let Some(sample) = sample
            && self.output.fits_an_answer()
        {
            if is_reported || fault.is_some() {
                self.output.send_later(sample);
            }
            if let Some(signals) = signals
                && let Some(telemetry) = self.subscription.telemetry(sample.sequence, &signals)
            {
                self.output.send_later(telemetry);
            }
        }
        if let Some(fault) = fault {
            self.output.send_later(fault);
        }
    }

    /// Latches a fault if the drive runs in bench mode: the next tick is overdue, at 1.5 periods after the last one. For an owner
    /// whose monitor of the tick is more precise than its calls of [`Self::tick`].
    pub fn miss_tick(&mut self, now: Duration) {
        let Some(pins) = self.lifecycle.run().and_then(Run::pins) else { return };
        let violation = pins.overdue(now);
        let fault = self.latch(violation, now);
        self.output.send_later(fault);
    }

    /// The control period: the interval of [`Self::sample`].
    #[must_use]
    pub fn period(&self) -> Duration {
        Duration::from_micros(self.parameters.drive().period_us.into())
    }

    /// The control period of a run in bench mode; `None` in every other state.
    #[must_use]
    pub fn run_period(&self) -> Option<Duration> {
        self.lifecycle.run().and_then(Run::pins).map(PinRun::period)
    }

    /// Length in ns of the pulses that the inputs of the encoders are to ignore, from the next [`Self::sample`] on.
    #[must_use]
    pub fn encoder_filter_ns(&self) -> u32 {
        let of_run = self.lifecycle.run().and_then(Run::pins).map(|pins| pins.parameters().encoder_filter_ns);
        of_run.or_else(|| Some(self.parameters.pins()?.encoder_filter_ns)).unwrap_or_default()
    }

    /// Whether a run needs the measured current.
    #[must_use]
    pub fn measures_current(&self) -> bool {
        // A run has its parameters at hand.
        let of_run = self.lifecycle.run().and_then(Run::pins).map(|pins| pins.parameters().torque_source);
        let source = of_run.or_else(|| Some(self.parameters.bench_mode()?.torque_source));
        source == Some(TorqueSource::Current)
    }

    /// What the power stage has to do.
    #[must_use]
    pub fn stage_command(&self) -> StageCommand<'_> {
        let run = self.lifecycle.run();
        run.and_then(|run| Some((run, run.pins()?))).map_or(StageCommand::Off, |(run, pins)| {
            StageCommand::Torque {
                torque_nm: run.torque_nm(),
                speed_rad_s: run.motor_speed_rad_s(),
                modulation: pins.modulation(),
            }
        })
    }

    /// Takes a reference of the host. Only one that is refused is answered.
    pub(super) fn take_reference(&mut self, reference: &Reference, arrived: Duration) {
        // As a late sample: refused, then the fault that it revealed.
        let late = self.lifecycle.check_time(arrived).err().map(|violation| self.latch(violation, arrived));
        let taken = match &mut self.lifecycle {
            Lifecycle::Running { run, .. } => run.take_reference(*reference, arrived),
            Lifecycle::Boot
            | Lifecycle::Idle { .. }
            | Lifecycle::Armed { .. }
            | Lifecycle::Faulted { .. } => false,
        };
        if !taken {
            self.refuse(Reference::LAYOUT.kind, Outcome::WrongState);
        }
        if let Some(fault) = late {
            self.output.send(fault);
        }
    }
}
