//! From `Idle` to a run: what `Subscribe`, `Capture`, `Arm` and `Start` check.

use core::time::Duration;

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{Capture, CaptureRows, Subscribe};

use super::control_loop::ControlLoop;
use super::lifecycle::Lifecycle;
use super::machine::Drive;
use super::parameters::Parameters;
use super::pin_run::PinRun;
use super::refusal::Refusal;
use super::run::Source;
use super::scope::Captured;
use super::subscription::Subscription;
use crate::law::{LawSet, ParameterError};

impl<L: LawSet> Drive<L> {
    pub(super) fn subscribe(&mut self, request: &Subscribe) -> Result<(), Refusal> {
        let state = self.state();
        if matches!(state, State::Boot | State::Faulted) {
            return Err(Outcome::WrongState.into());
        }
        let subscription = Subscription::requested(request, L::SIGNALS)?;
        // In Idle the law may still change; arming checks it.
        if state != State::Idle {
            subscription.check(self.parameters.law(), L::SIGNALS)?;
        }
        self.subscription = subscription;
        Ok(())
    }

    /// Replaces the capture by the one of a request.
    pub(super) fn capture(&mut self, request: &Capture) -> Result<(), Refusal> {
        if matches!(self.state(), State::Boot | State::Faulted) {
            return Err(Outcome::WrongState.into());
        }
        let capture = Captured::requested(request, L::SIGNALS)?;
        // The law may still change in Idle; arming checks it again.
        capture.check(self.parameters.law(), L::SIGNALS)?;
        self.scope.set(capture);
        Ok(())
    }

    pub(super) fn read_capture(&mut self, first: u16) -> Result<CaptureRows, Refusal> {
        if self.lifecycle.run().is_none() {
            self.scope.end_run();
        }
        self.scope.read(first)
    }

    pub(super) fn arm(&mut self, session: u32) -> Result<(), Refusal> {
        self.check_session(session)?;
        if self.state() != State::Idle {
            return Err(Outcome::WrongState.into());
        }
        if self.subscription.has_rate() {
            self.subscription.check(self.parameters.law(), L::SIGNALS)?;
        }
        self.scope.check(self.parameters.law(), L::SIGNALS)?;
        // Not by `map_err`, which moves the law once more.
        let control = match self.control() {
            Ok(control) => control,
            Err(error) => return Err(Parameters::<L>::inconsistent(&error)),
        };
        self.check_pins()?;
        self.lifecycle = Lifecycle::Armed { session, control };
        Ok(())
    }

    fn control(&self) -> Result<ControlLoop<L>, ParameterError> {
        let limits = match (self.parameters.bench_mode(), &self.pins) {
            (Some(parameters), Some(pins)) => {
                let modulation = parameters.modulation(pins.hardware())?;
                modulation.check(self.parameters.drive().torque_limit_nm)?;
                parameters.check_travel()?;
                Some(pins.hardware().limits(parameters.encoder_filter_ns)?)
            }
            _ => None,
        };
        ControlLoop::new(&self.parameters, limits.as_ref())
    }

    pub(super) fn start(&mut self, session: u32, now: Duration) -> Result<(), Refusal> {
        self.check_session(session)?;
        // What was plausible at `Arm` may no longer be.
        if self.state() == State::Armed {
            self.check_pins()?;
        }
        let drive = self.parameters.drive();
        let source = match (self.parameters.bench_mode(), &self.pins) {
            (Some(parameters), Some(pins)) => match PinRun::new(parameters, &drive, pins, now) {
                Ok(run) => Source::Pins(run),
                // Never after `Arm`, and no run without a modulation.
                Err(error) => return Err(Parameters::<L>::inconsistent(&error)),
            },
            _ => Source::Link { last_answer: None },
        };
        self.lifecycle.start(&drive, source, now)?;
        self.scope.begin_run();
        self.begin_counts();
        Ok(())
    }

    fn check_session(&self, session: u32) -> Result<(), Outcome> {
        if self.lifecycle.session() == Some(session) { Ok(()) } else { Err(Outcome::WrongSession) }
    }

    /// Whether the pins allow torque; `Ok` in HIL mode.
    fn check_pins(&self) -> Result<(), Refusal> {
        let (Some(pins), Some(parameters)) = (&self.pins, self.parameters.bench_mode()) else {
            return Ok(());
        };
        if let Some(fault) = parameters.missing_enable(&pins.readings()) {
            return Err(Refusal { outcome: Outcome::PowerStageFault, detail: fault as u32 });
        }
        pins.check(&self.parameters.drive())
    }
}
