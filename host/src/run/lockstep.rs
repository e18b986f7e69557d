//! The loop in lockstep: the plant waits for the drive, the drive waits for the plant, and no clock has a say.
//!
//! So a run is the same bit for bit whatever carries the bytes and however busy the machine is, and as fast as the link
//! allows. A sample that stays unanswered is given up after its time: the last torque is held for that period, as it is
//! on a real bench, and counted.

use std::time::Instant;

use lashloop_protocol::message::TorqueAnswer;
use lashloop_protocol::vocabulary::State;

use super::bench::Bench;
use super::{End, Outcome, RunError, setup};
use crate::device::{Device, DeviceError};
use crate::metrics::{Measurement, Sample};
use crate::plant::PlantError;
use crate::record::RecordError;
use crate::record::digest::TorqueDigest;
use crate::record::trace::TraceRow;
use crate::scenario::Scenario;
use crate::session::{Exchange, Session, Traffic};
use crate::verdict::{Judgement, LinkCounts};

/// Whoever looks on: a record, a progress bar, a plot.
pub trait Watcher {
    /// A row of the trace is complete.
    ///
    /// # Errors
    /// It could not be kept; the run ends.
    fn row(&mut self, row: &TraceRow) -> Result<(), RecordError>;

    /// Whether the run is to end early. Asked once in a step.
    fn stop_asked(&self) -> bool {
        false
    }
}

/// Runs a scenario on a device and judges it.
///
/// # Errors
/// The scenario does not fit the drive, the device or the link failed, or the record could not be written. The watcher
/// has seen every row up to then.
pub fn run(scenario: &Scenario, device: &mut Device, watcher: &mut dyn Watcher) -> Result<Outcome, RunError> {
    let bench = Bench::new(scenario)?;
    setup::set_up(device, scenario)?;
    let before = device.session.traffic();
    if let Err(source) = device.session.start() {
        // It may be armed, or even running if only its answer was lost.
        device.session.abandon();
        return Err(setup::refused_start(device, source));
    }
    let mut run = Lockstep {
        scenario,
        bench,
        watcher,
        measurement: Measurement::new(scenario.run.control_period_s())
            .with_middle_of_reference(scenario.reference.middle_rad()),
        digest: TorqueDigest::default(),
        torque_nm: 0.0,
        lost: 0,
        unanswered_since: None,
        steps: 0,
        unfinished_row: None,
    };
    let started = Instant::now();
    let end = run.close_the_loop(device);
    let wall_s = started.elapsed().as_secs_f64();
    // The last telemetry comes before the answer to the stop, and the last row waits for it.
    let stopped = match &end {
        Ok(end) if !end.is_death() => device.session.stop().map_err(|source| device.explain(source)),
        _ => {
            device.session.abandon();
            Ok(())
        }
    };
    run.finish_row(device)?;
    let end = end?;
    stopped?;
    if matches!(end, End::Diverged(_)) {
        run.measurement.diverged();
    }
    let link = link_counts(run.lost, before, &device.session);
    let metrics = run.measurement.metrics();
    let mut judgement = Judgement::new(&scenario.expectations, &metrics, &scenario.allow, &link);
    judgement.cap(end.verdict());
    Ok(Outcome {
        judgement,
        end,
        metrics,
        link,
        steps: run.steps,
        simulated_s: run.steps as f64 * scenario.run.control_period_s(),
        wall_s,
        torque_sha256: run.digest.finish(),
        logs: device.session.take_logs(),
    })
}

struct Lockstep<'a> {
    scenario: &'a Scenario,
    bench: Bench,
    watcher: &'a mut dyn Watcher,
    measurement: Measurement,
    digest: TorqueDigest,
    /// What the motor is given at present.
    torque_nm: f32,
    lost: u64,
    /// When the first sample of those was sent that have no answer yet.
    unanswered_since: Option<Instant>,
    steps: u64,
    /// The row of the last step: its telemetry follows its torque, so it is complete only with the next one.
    unfinished_row: Option<TraceRow>,
}

impl Lockstep<'_> {
    fn close_the_loop(&mut self, device: &mut Device) -> Result<End, RunError> {
        for sequence in 0..self.scenario.run.steps() {
            if self.watcher.stop_asked() {
                return Ok(End::Interrupted);
            }
            match self.step(sequence, device) {
                Ok(None) => {}
                Ok(Some(end)) => return Ok(end),
                Err(StepError::Plant(error)) => return Ok(End::Diverged(error)),
                Err(StepError::Run(error)) => return Err(error),
            }
        }
        Ok(End::Complete)
    }

    fn step(&mut self, sequence: u32, device: &mut Device) -> Result<Option<End>, StepError> {
        let (sample, row) = self.bench.observe(sequence)?;
        let link = &self.scenario.link;
        let asked = Instant::now();
        let since = *self.unanswered_since.get_or_insert(asked);
        let patience = link.silence_limit().saturating_sub(asked - since);
        let exchange = device.session.exchange(&sample, link.answer_timeout().min(patience));
        match exchange.map_err(|source| device.explain(source))? {
            Exchange::Answered(answer) => {
                if answer.state != State::Running {
                    return Ok(Some(drive_fault(device, &answer)?));
                }
                if !answer.torque_nm.is_finite() {
                    return Err(device.unfit(format!("it gave a torque of {} N m", answer.torque_nm)).into());
                }
                self.torque_nm = answer.torque_nm;
                self.unanswered_since = None;
            }
            Exchange::Faulted(fault) => return Ok(Some(End::DriveFault(fault))),
            Exchange::Unanswered => self.lost_answer(since, device)?,
        }
        self.finish_row(device)?;
        self.unfinished_row = Some(TraceRow { torque_nm: self.torque_nm.into(), ..row });
        self.digest.push(self.torque_nm);
        self.steps += 1;
        self.bench.step(self.torque_nm)?;
        Ok(None)
    }

    fn lost_answer(&mut self, since: Instant, device: &Device) -> Result<(), DeviceError> {
        let limit = self.scenario.link.silence_limit();
        if since.elapsed() >= limit {
            return Err(device.explain(device.session.silent(limit)));
        }
        self.lost += 1;
        Ok(())
    }

    fn finish_row(&mut self, device: &Device) -> Result<(), RecordError> {
        let Some(mut row) = self.unfinished_row.take() else { return Ok(()) };
        if let Some(telemetry) = device.session.telemetry() {
            row.dead_zone_estimate_rad = telemetry.dead_zone_estimate_rad.into();
        }
        self.measurement.push(&Sample {
            time_s: row.time_s,
            reference_rad: row.reference_rad,
            load_position_rad: row.load_position_rad,
            torque_nm: row.torque_nm,
            dead_zone_estimate_rad: row.dead_zone_estimate_rad,
            dead_zone_rad: row.dead_zone_rad,
        });
        self.watcher.row(&row)
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

fn link_counts(lost: u64, before: Traffic, session: &Session) -> LinkCounts {
    let after = session.traffic();
    let at_drive = session.line_report();
    LinkCounts {
        frames_sent: after.frames_sent - before.frames_sent,
        frames_received: after.frames_received - before.frames_received,
        crc_errors: after.damaged - before.damaged,
        lost,
        late: after.late - before.late,
        damaged_at_drive: at_drive.map_or(0, |report| report.damaged.into()),
        overruns_at_drive: at_drive.map_or(0, |report| report.overruns.into()),
    }
}

enum StepError {
    /// The plant can't go on, which is a result.
    Plant(PlantError),
    /// The run can't go on, which is not.
    Run(RunError),
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

impl From<RecordError> for StepError {
    fn from(error: RecordError) -> Self {
        Self::Run(error.into())
    }
}
