//! One step of the loop, whatever paces it: observe, ask, hold the torque for a period.
//!
//! A sample that is not answered by its deadline is given up: the last torque is held for that period, as it is on a real
//! bench, and the step is counted. Nothing here allocates, locks or logs.

use std::thread;
use std::time::{Duration, Instant};

use lashloop_protocol::enums::State;
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};

use super::simulator::Simulator;
use super::step_sink::Step;
use super::{End, RunError, setup};
use crate::device::{Device, DeviceError};
use crate::fault::log::FaultRecord;
use crate::fault::timeline::Timeline;
use crate::record::trace::TraceRow;
use crate::scenario::Scenario;
use crate::scenario::sections::OnLoss;
use crate::session::{Exchange, SessionError};
use crate::timing::{ClockName, RoundTrip, StepOutcome, StepTiming};
use lashloop_plant::PlantError;

/// Time between two attempts to get a lost drive back.
const RESUME_INTERVAL: Duration = Duration::from_millis(50);

/// Time that a start may take in real time to be of use: less than what it waits for a lost answer.
const START_LIMIT: Duration = Duration::from_millis(250);

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
    simulator: Simulator,
    sink: S,
    timeline: Timeline,
    clock: ClockName,
    resumes: u64,
    /// The sample with sequence 0. A drive takes no other first, so until it is answered it is sent in every step, as it
    /// was: the drive may have taken it, and only its answer was lost.
    first: Option<EncoderSample>,
    /// The step of that sample.
    origin: u32,
    is_answered: bool,
    /// Not from when a lost drive has been set up again to the step that asks it.
    is_started: bool,
    /// How long the drive gives torque without a new sample. `None` in lockstep, where its time is not the plant's.
    watchdog: Option<Duration>,
    /// What the motor is given at present.
    torque_nm: f32,
    /// Steps since the one whose torque that is.
    held: u32,
    unanswered: u64,
    /// When the first sample of those was sent that have no answer yet.
    unanswered_since: Option<Instant>,
    steps: u64,
    /// The last step: its telemetry follows its torque, so it is complete only with the next one.
    unfinished: Option<Step>,
}

impl<'a, S: Sink> ControlLoop<'a, S> {
    pub(super) fn new(
        scenario: &'a Scenario,
        simulator: Simulator,
        timeline: Timeline,
        clock: ClockName,
        watchdog: Option<Duration>,
        sink: S,
    ) -> Self {
        Self {
            scenario,
            simulator,
            sink,
            timeline,
            clock,
            resumes: 0,
            first: None,
            origin: 0,
            is_answered: false,
            is_started: true,
            watchdog,
            torque_nm: 0.0,
            held: 0,
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

    /// Times that the drive was lost and came back.
    pub(super) fn resumes(&self) -> u64 {
        self.resumes
    }

    /// When the drive will have been silent for longer than the scenario bears.
    fn silent_at(&self, now: Instant) -> Instant {
        self.unanswered_since.unwrap_or(now) + self.scenario.link.silence_limit()
    }

    /// Asks the drive for a torque, at the latest by `deadline`, and holds it for a period. `lateness` is how long after
    /// its due time the step begins.
    pub(super) fn step(
        &mut self,
        step: u32,
        deadline: Instant,
        lateness: Duration,
        device: &mut Device,
    ) -> Result<Option<End>, StepError> {
        if !self.is_started
            && let Some(end) = self.start_again(device)?
        {
            return Ok(Some(end));
        }
        self.begin(step, device)?;
        let (sample, row) = self.simulator.observe(step)?;
        if !self.is_started {
            // It was lost again, or its start came to nothing: the next step tries it once more.
            let (outcome, round_trip) = self.give_up();
            self.finish(device)?;
            self.hold(step, row, StepTiming { lateness, outcome, round_trip })?;
            return Ok(None);
        }
        let is_sent_again = self.first.is_some() && !self.is_answered;
        let (number, sample) = self.place(step, sample)?;
        let asked = Instant::now();
        let exchange = device.session.exchange(number, &sample, deadline.min(self.silent_at(asked)));
        let exchange = match exchange {
            Err(source) if source.is_loss() => {
                if let Some(end) = self.lose(source, device)? {
                    return Ok(Some(end));
                }
                None
            }
            exchange => Some(exchange.map_err(|source| device.explain(source))?),
        };
        let (outcome, round_trip) = match exchange {
            Some(Exchange::Answered(answer)) => {
                if answer.status.state != State::Running {
                    return Ok(Some(drive_fault(device, &answer)?));
                }
                if !answer.torque_nm.is_finite() {
                    return Err(device.unfit(format!("it gave a torque of {} N m", answer.torque_nm)).into());
                }
                self.unanswered_since = None;
                self.is_answered = true;
                let timestamps = device.session.timestamps();
                if self.clock == ClockName::RealTime && timestamps.arrived > deadline {
                    // The bench itself was late to read it; the motor has been without it all the same.
                    (StepOutcome::Unanswered, None)
                } else {
                    self.torque_nm = answer.torque_nm;
                    // To which sending it is the answer can't be known.
                    let round_trip = (!is_sent_again).then(|| RoundTrip::new(&timestamps, &answer));
                    (StepOutcome::Answered, round_trip)
                }
            }
            Some(Exchange::Faulted(fault)) => return Ok(Some(End::DriveFault(fault))),
            Some(Exchange::Unanswered) if Instant::now() >= self.silent_at(asked) => {
                let silent = device.session.silent(self.scenario.link.silence_limit());
                if let Some(end) = self.lose(silent, device)? {
                    return Ok(Some(end));
                }
                self.give_up()
            }
            Some(Exchange::Unanswered) => {
                self.unanswered_since.get_or_insert(asked);
                self.give_up()
            }
            // The drive was lost, and is there again.
            None => self.give_up(),
        };
        self.finish(device)?;
        self.hold(step, row, StepTiming { lateness, outcome, round_trip })?;
        Ok(None)
    }

    /// The sample to be sent in a step, and its number since the start of the drive.
    fn place(&mut self, step: u32, sample: EncoderSample) -> Result<(u32, EncoderSample), RunError> {
        match self.first {
            Some(_) if self.is_answered => Ok((step - self.origin, sample)),
            Some(first) => Ok((0, first)),
            None => {
                self.simulator.check_start(&sample)?;
                (self.first, self.origin) = (Some(sample), step);
                Ok((0, sample))
            }
        }
    }

    fn give_up(&mut self) -> (StepOutcome, Option<RoundTrip>) {
        self.unanswered += 1;
        (StepOutcome::Unanswered, None)
    }

    fn begin(&mut self, step: u32, device: &mut Device) -> Result<(), StepError> {
        match self.timeline.begin(step, device) {
            // The step is about to find out.
            Err(source) if source.is_loss() => Ok(()),
            result => Ok(result.map_err(|source| device.explain(source))?),
        }
    }

    /// The drive is gone, or was started anew. Gets it back if the scenario asks for that, or else returns how the run
    /// ends.
    fn lose(&mut self, source: SessionError, device: &mut Device) -> Result<Option<End>, StepError> {
        let link = &self.scenario.link;
        if link.on_loss == OnLoss::End {
            return match source {
                SessionError::Refused { state: State::Boot, .. } => Ok(Some(End::DriveRestarted)),
                source => Err(device.explain(source).into()),
            };
        }
        // A drive without a host gives no torque, and it is set up, armed and started from there.
        self.torque_nm = 0.0;
        self.timeline.pause();
        let deadline = Instant::now() + link.resume_limit();
        let lost = *device.session.identity();
        loop {
            self.timeline.revive(device);
            let Err(error) = setup::resume(device, self.scenario, self.clock, &lost) else { break };
            if self.sink.stop_asked() {
                return Ok(Some(End::Interrupted));
            }
            let may_pass = matches!(&error, RunError::Device(error) if error.may_pass());
            if !may_pass || Instant::now() >= deadline {
                return Err(error.into());
            }
            thread::sleep(RESUME_INTERVAL);
        }
        (self.is_started, self.is_answered) = (false, false);
        (self.first, self.unanswered_since) = (None, None);
        self.resumes += 1;
        Ok(None)
    }

    /// Starts a drive that was lost and has been set up. Not before the step that asks it again: its watchdog runs from
    /// here on, and in real time the steps that were missed had to be made up for first. If the start itself has taken so long
    /// that many more were missed, it is taken back and made again in the step in which those are made up for.
    fn start_again(&mut self, device: &mut Device) -> Result<Option<End>, StepError> {
        let began = Instant::now();
        self.timeline.pause();
        let started = device.session.start().and_then(|()| {
            let is_late = self.clock == ClockName::RealTime && began.elapsed() > START_LIMIT;
            if is_late { device.session.disarm().map(|()| false) } else { Ok(true) }
        });
        match started {
            Ok(is_started) => {
                self.is_started = is_started;
                Ok(None)
            }
            Err(source) if source.is_loss() => self.lose(source, device),
            Err(source) => Err(setup::refused_start(device, source).into()),
        }
    }

    /// Holds the last torque for a step in which the drive was not asked.
    pub(super) fn miss(&mut self, step: u32, device: &mut Device) -> Result<(), StepError> {
        self.begin(step, device)?;
        let (_, row) = self.simulator.observe(step)?;
        self.finish(device)?;
        self.hold(
            step,
            row,
            StepTiming { lateness: Duration::ZERO, outcome: StepOutcome::Missed, round_trip: None },
        )
    }

    fn hold(&mut self, step: u32, mut row: TraceRow, timing: StepTiming) -> Result<(), StepError> {
        self.held = if timing.outcome == StepOutcome::Answered { 0 } else { self.held.saturating_add(1) };
        let held_for = Duration::from_micros(self.scenario.run.control_period_us.into()) * self.held;
        if self.watchdog.is_some_and(|watchdog| held_for >= watchdog) {
            // If the samples were lost, the drive's watchdog has tripped; if only the answers were, nobody here can know.
            self.torque_nm = 0.0;
        }
        row.torque_nm = self.torque_nm.into();
        self.unfinished = Some(Step { row, timing });
        self.steps += 1;
        Ok(self.simulator.step(step, self.torque_nm)?)
    }

    /// The line is healed and the drive goes on, whatever was wrong with them. Returns what was.
    pub(super) fn end_faults(&mut self, device: &Device) -> Vec<FaultRecord> {
        self.timeline.end(device)
    }

    /// Hands over the last step, with the estimates the drive has told of by now.
    pub(super) fn finish(&mut self, device: &Device) -> Result<(), RunError> {
        let Some(mut step) = self.unfinished.take() else { return Ok(()) };
        if let Some(telemetry) = device.session.telemetry() {
            let row = &mut step.row;
            row.dead_zone_estimate_rad = telemetry.dead_zone_estimate_rad.into();
            row.disturbing_torque_estimate_nm = telemetry.disturbing_torque_nm.into();
            row.motor_error_rad = telemetry.motor_error_rad.into();
            // Not as integers: a drive may name any sequence.
            let told_of = f64::from(self.origin) + f64::from(telemetry.step);
            row.estimate_time_s = told_of * self.scenario.run.control_period_s();
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
            .unfit(format!("state {:?} in the middle of the run, without a fault", answer.status.state))
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
