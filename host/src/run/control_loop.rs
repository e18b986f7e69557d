//! One step of the loop, whatever paces it: observe, ask, hold the torque for a period.
//!
//! A sample that is not answered by its deadline is given up: the last torque is held for that period, as it is on a real
//! bench, and the step is counted. Nothing here allocates, locks or logs.

use std::time::{Duration, Instant};

use lashloop_protocol::message::TorqueAnswer;
use lashloop_protocol::vocabulary::State;

use super::bench::Bench;
use super::keeper::Step;
use super::{End, RunError};
use crate::device::{Device, DeviceError};
use crate::plant::PlantError;
use crate::record::trace::TraceRow;
use crate::scenario::Scenario;
use crate::session::Exchange;
use crate::timing::{Fate, RoundTrip, StepTiming};

/// Where finished steps go.
pub(super) trait Sink {
    /// Takes the next step.
    ///
    /// # Errors
    /// It can't be kept; the run ends.
    fn take(&mut self, step: Step) -> Result<(), RunError>;

    /// Whether the run is to end early. Asked once in a step.
    fn stop_asked(&self) -> bool;
}

/// The loop of one run.
pub(super) struct ControlLoop<'a, S> {
    scenario: &'a Scenario,
    bench: Bench,
    sink: S,
    /// What the motor is given at present.
    torque_nm: f32,
    unanswered: u64,
    /// When the first sample of those was sent that have no answer yet.
    unanswered_since: Option<Instant>,
    steps: u64,
    /// The last step: its telemetry follows its torque, so it is complete only with the next one.
    unfinished: Option<Step>,
}

impl<'a, S: Sink> ControlLoop<'a, S> {
    pub(super) fn new(scenario: &'a Scenario, bench: Bench, sink: S) -> Self {
        Self {
            scenario,
            bench,
            sink,
            torque_nm: 0.0,
            unanswered: 0,
            unanswered_since: None,
            steps: 0,
            unfinished: None,
        }
    }

    pub(super) fn stop_asked(&self) -> bool {
        self.sink.stop_asked()
    }

    /// Steps made, missed ones included.
    pub(super) fn steps(&self) -> u64 {
        self.steps
    }

    /// Samples that had no torque by their deadline.
    pub(super) fn unanswered(&self) -> u64 {
        self.unanswered
    }

    /// When the drive will have been silent for longer than the scenario bears.
    fn silent_at(&self, now: Instant) -> Instant {
        self.unanswered_since.unwrap_or(now) + self.scenario.link.silence_limit()
    }

    /// Asks the drive for a torque, at the latest by `deadline`, and holds it for a period. `lateness` is how long after
    /// its due time the step begins.
    pub(super) fn step(
        &mut self,
        sequence: u32,
        deadline: Instant,
        lateness: Duration,
        device: &mut Device,
    ) -> Result<Option<End>, StepError> {
        let (sample, row) = self.bench.observe(sequence)?;
        let asked = Instant::now();
        let exchange = device.session.exchange(&sample, deadline.min(self.silent_at(asked)));
        let (fate, round_trip) = match exchange.map_err(|source| device.explain(source))? {
            Exchange::Answered(answer) => {
                if answer.state != State::Running {
                    return Ok(Some(drive_fault(device, &answer)?));
                }
                if !answer.torque_nm.is_finite() {
                    return Err(device.unfit(format!("it gave a torque of {} N m", answer.torque_nm)).into());
                }
                self.torque_nm = answer.torque_nm;
                self.unanswered_since = None;
                (Fate::Answered, Some(RoundTrip::new(&device.session.moments(), &answer)))
            }
            Exchange::Faulted(fault) => return Ok(Some(End::DriveFault(fault))),
            Exchange::Unanswered => {
                if Instant::now() >= self.silent_at(asked) {
                    let limit = self.scenario.link.silence_limit();
                    return Err(device.explain(device.session.silent(limit)).into());
                }
                self.unanswered_since.get_or_insert(asked);
                self.unanswered += 1;
                (Fate::Unanswered, None)
            }
        };
        self.finish(device)?;
        self.hold(row, StepTiming { lateness, fate, round_trip })?;
        Ok(None)
    }

    /// Holds the last torque for a step in which the drive was not asked.
    pub(super) fn miss(&mut self, sequence: u32, device: &Device) -> Result<(), StepError> {
        let (_, row) = self.bench.observe(sequence)?;
        self.finish(device)?;
        self.hold(row, StepTiming { lateness: Duration::ZERO, fate: Fate::Missed, round_trip: None })
    }

    fn hold(&mut self, mut row: TraceRow, timing: StepTiming) -> Result<(), StepError> {
        row.torque_nm = self.torque_nm.into();
        self.unfinished = Some(Step { row, timing });
        self.steps += 1;
        Ok(self.bench.step(self.torque_nm)?)
    }

    /// Hands over the last step, with the estimate the drive has told of by now.
    pub(super) fn finish(&mut self, device: &Device) -> Result<(), RunError> {
        let Some(mut step) = self.unfinished.take() else { return Ok(()) };
        if let Some(telemetry) = device.session.telemetry() {
            step.row.dead_zone_estimate_rad = telemetry.dead_zone_estimate_rad.into();
        }
        self.sink.take(step)
    }
}

/// The report of a fault follows the answer that shows it; asking for the state brings it in.
fn drive_fault(device: &mut Device, answer: &TorqueAnswer) -> Result<End, RunError> {
    if device.session.fault().is_none() {
        let stopped = device.session.stop();
        stopped.map_err(|source| device.explain(source))?;
    }
    match device.session.fault() {
        Some(fault) => Ok(End::DriveFault(fault)),
        None => Err(device
            .unfit(format!("state {:?} in the middle of the run, without a fault", answer.state))
            .into()),
    }
}

/// Why a step could not be made.
pub(super) enum StepError {
    /// The plant can't go on, which is a result.
    Plant(PlantError),
    /// The run can't go on, which is not.
    Run(RunError),
}

impl StepError {
    /// As the end of a run, if it is one.
    pub(super) fn end(self) -> Result<End, RunError> {
        match self {
            Self::Plant(error) => Ok(End::Diverged(error)),
            Self::Run(error) => Err(error),
        }
    }
}

impl From<PlantError> for StepError {
    fn from(error: PlantError) -> Self {
        Self::Plant(error)
    }
}

impl From<RunError> for StepError {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

impl From<DeviceError> for StepError {
    fn from(error: DeviceError) -> Self {
        Self::Run(error.into())
    }
}
