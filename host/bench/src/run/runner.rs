//! From a scenario and a device to a verdict.

use std::sync::atomic::AtomicBool;

use lashloop_link::TimeBase;

use super::clock::Clock;
use super::device_under_test::DeviceUnderTest;
use super::drive_settings::takes_torque;
use super::error::RunError;
use super::loop_state::{Counts, LoopSettings};
use super::outcome::{End, Outcome};
use super::real_time::{self, RealTime, Ring};
use super::run_loop::RunLoop;
use super::simulator::Simulator;
use super::step_recorder::StepRecorder;
use super::step_sink::{RunStart, StepObserver, StepSink};
use super::{lockstep, setup};
use crate::device::{Device, DriveHost};
use crate::fault::timeline::FaultRecord;
use crate::fault::timeline::Timeline;
use crate::scenario::{RunMode, Scenario};
use crate::timing::ClockName;
use crate::verdict::{Judgement, LinkCounts};
use lashloop_plant::metrics::SignalTable;
use lashloop_plant::{PlantError, Signal};
use lashloop_protocol::parameter_names::SAMPLE_SOURCE;
use lashloop_session::{CapturedRows, Session, Traffic};

/// Runs a scenario on a device and judges it.
///
/// # Errors
/// The scenario does not fit the drive, the device or the link failed, or the record could not be written. The observer
/// has received every step up to then, and the error.
pub fn run(
    scenario: &Scenario,
    under_test: &mut DeviceUnderTest,
    clock: Clock,
    observer: &mut dyn StepObserver,
) -> Result<Outcome, RunError> {
    let ended = observed(scenario, under_test, clock, observer);
    ended.inspect_err(|error| observer.failed(error))
}

fn observed(
    scenario: &Scenario,
    under_test: &mut DeviceUnderTest,
    clock: Clock,
    observer: &mut dyn StepObserver,
) -> Result<Outcome, RunError> {
    let DeviceUnderTest { device, link_faults } = under_test;
    let (simulator, plant_signals) = simulator(scenario, device, clock)?;
    let timeline = Timeline::new(scenario, device, link_faults.clone())?;
    let is_timed = clock != Clock::Untimed || !matches!(device.connection.host, DriveHost::InProcess(_));
    device.session.line.set_time_base(match clock {
        Clock::Untimed if !is_timed => TimeBase::Scripted,
        Clock::Lockstep | Clock::Untimed => TimeBase::Virtual,
        Clock::RealTime(_) => TimeBase::WallClock,
        Clock::Scripted => TimeBase::Scripted,
    });
    let drive = setup::set_up(device, scenario, clock.name())?;
    let signals = SignalTable { plant: plant_signals, drive };
    let measured = measured_signals(scenario.run.mode, &signals);
    scenario.check_expectations(&measured)?;
    let watchdog = match clock {
        Clock::Lockstep | Clock::Untimed => None,
        Clock::RealTime(_) | Clock::Scripted => Some(setup::watchdog(device)?),
    };
    let torque_limit_nm = setup::torque_limit_nm(device)?;
    observer.begin(&RunStart { scenario, clock, device, signals: &signals })?;
    let before = device.session.traffic();
    let settings = LoopSettings {
        clock: clock.name(),
        is_timed,
        watchdog,
        plant_signals: signals.plant.len(),
        drive_signals: signals.drive.len(),
        torque_limit_nm,
        takes_torque: takes_torque(scenario, &device.session),
    };
    let mut recorder = StepRecorder::new(scenario, &measured, clock.name(), observer);
    let (closed, refused) = match clock {
        Clock::Lockstep | Clock::Untimed | Clock::Scripted => {
            let control = RunLoop::new(scenario, simulator, timeline, settings, &mut recorder);
            let closed = run_to_end(control, device, scenario.run.mode, |control, device| match clock {
                Clock::Scripted => real_time::close(control, scenario, device, None),
                _ => lockstep::close(control, scenario, device),
            });
            (closed?, Vec::new())
        }
        Clock::RealTime(options) => {
            in_real_time(scenario, simulator, timeline, settings, device, &options, &mut recorder)?
        }
    };
    let Closed { end, counts: Counts { steps, unanswered, resumes }, wall_s, faults, scope } = closed;
    if matches!(end, End::Diverged(_)) {
        recorder.measurement.diverged();
    }
    let link = LinkCounts { resumes, ..link_counts(unanswered, before, &device.session, clock.name()) };
    let timing = recorder.timings.report(refused);
    let metrics = recorder.metrics();
    let mut judgement = Judgement::new(&scenario.expectations, &metrics, &scenario.allow, &link, &timing);
    match &end {
        End::RuleBroken(_) => judgement.fail(),
        end => judgement.cap(end.verdict()),
    }
    Ok(Outcome {
        judgement,
        end,
        metrics,
        link,
        timing,
        faults,
        steps: steps.into(),
        simulated_s: f64::from(steps) * scenario.run.control_period_s(),
        wall_s,
        torque_sha256: recorder.digest.finish(),
        logs: device.session.line.logs.take(),
        signals,
        scope,
    })
}

/// The simulator in HIL mode, and the signals of the plant in the record.
fn simulator(
    scenario: &Scenario,
    device: &Device,
    clock: Clock,
) -> Result<(Option<Simulator>, Vec<Signal>), RunError> {
    match scenario.run.mode {
        RunMode::Hil => {
            let simulator = Simulator::new(scenario)?;
            let signals = simulator.signals().to_vec();
            Ok((Some(simulator), signals))
        }
        RunMode::Bench => {
            check_bench_mode(device, clock.name())?;
            // The columns of HIL mode, without values.
            let plant = scenario.plant.release(&scenario.run)?;
            Ok((None, plant.signals().to_vec()))
        }
    }
}

/// Whether a drive can make a run in bench mode under this clock.
///
/// # Errors
/// It has no pins, or another time.
pub fn check_bench_mode(device: &Device, clock: ClockName) -> Result<(), RunError> {
    let choice = &device.connection.choice;
    let has_pins = device.session.parameter(SAMPLE_SOURCE).is_some();
    match (choice.keeps_bench_clock(clock), has_pins) {
        (true, true) => Ok(()),
        (true, false) => Err(device
            .unfit(format!(
                "it has no parameter {SAMPLE_SOURCE}, so it has no bench mode: take a board with encoders and a power stage, or \
                 run.mode = \"hil\""
            ))
            .into()),
        (false, true) => Err(RunError::BenchClock { device: choice.to_string(), clock }),
        (false, false) => Err(RunError::NoPins { device: choice.to_string() }),
    }
}

/// The signals that a run measures. Those of the plant are the truth of a simulator.
fn measured_signals(mode: RunMode, signals: &SignalTable) -> SignalTable {
    match mode {
        RunMode::Hil => signals.clone(),
        RunMode::Bench => SignalTable { plant: Vec::new(), drive: signals.drive.clone() },
    }
}

/// A loop that has ended, with its drive stopped.
struct Closed {
    end: End,
    counts: Counts,
    wall_s: f64,
    faults: Vec<FaultRecord>,
    scope: Option<CapturedRows>,
}

/// Runs the loop on its own thread and the recorder on this one.
fn in_real_time(
    scenario: &Scenario,
    simulator: Option<Simulator>,
    timeline: Timeline,
    settings: LoopSettings,
    device: &mut Device,
    options: &RealTime,
    recorder: &mut StepRecorder<'_>,
) -> Result<(Closed, Vec<String>), RunError> {
    let stop = AtomicBool::new(false);
    let (ring, mut steps) = Ring::new(&stop);
    let mut recorded = Ok(());
    let mut recorder = recorder;
    let work = || {
        let refused = real_time::obtain(options);
        let control = RunLoop::new(scenario, simulator, timeline, settings, ring);
        let closed = run_to_end(control, device, scenario.run.mode, |control, device| {
            real_time::close(control, scenario, device, Some(options.spin))
        });
        (closed, refused)
    };
    let drain = || {
        if recorded.is_ok() {
            recorded = real_time::drain(&mut steps, &mut recorder, &stop);
        }
    };
    let (closed, refused) = real_time::run_with_drain(work, drain)?;
    // A failed recorder is why the loop was stopped, so its error comes first.
    recorded?;
    Ok((closed?, refused))
}

/// Starts the drive, closes the loop and stops the drive.
fn run_to_end<'a, S: StepSink>(
    mut control: RunLoop<'a, S>,
    device: &mut Device,
    mode: RunMode,
    close: impl FnOnce(&mut RunLoop<'a, S>, &mut Device) -> Result<End, RunError>,
) -> Result<Closed, RunError> {
    // Last of all, because the drive's watchdog runs from here on.
    if let Err(source) = setup::start(device, mode) {
        // The drive may be armed, or even running if only its answer was lost.
        device.session.abandon();
        return Err(setup::refused_start(device, source));
    }
    let started = device.session.line.timestamp();
    let end = match close(&mut control, device) {
        Err(RunError::Integration(PlantError::Interrupted)) => Ok(End::Interrupted),
        // A result of the run, unless the plant broke down for a reason of its own.
        Err(RunError::Integration(error)) if !matches!(error, PlantError::Failed(_)) => {
            Ok(End::Diverged(error))
        }
        end => end,
    };
    let wall_s = (device.session.line.timestamp() - started).as_secs_f64();
    let faults = control.state().timeline.end(device);
    // The last telemetry comes before the answer to the stop, and the last row waits for it.
    let stopped = match &end {
        Ok(end) if end.leaves_a_session() => {
            // On a line that lost samples a partial frame may precede the stop.
            let has_gaps = control.state().counts.unanswered > 0;
            let cleared = if has_gaps { device.session.line.end_frame() } else { Ok(()) };
            let stopped = cleared.and_then(|()| device.session.stop());
            stopped.map_err(|source| device.explain(source))
        }
        _ => {
            device.session.abandon();
            Ok(())
        }
    };
    if stopped.is_err() {
        device.session.abandon();
    }
    let can_be_read = stopped.is_ok() && end.as_ref().is_ok_and(End::leaves_a_session);
    let scope = if can_be_read { captured(device) } else { None };
    let end = end.map(|end| with_own_names(end, device));
    if let Some(warning) = device.session.telemetry_warning() {
        device.session.line.logs.note(warning);
    }
    let last = control.state().counts.steps;
    let finished = control.finish(device);
    control.pass_events_on(last, device)?;
    finished?;
    let end = end?;
    // The end of a run that was cut short matters more than a stop that failed after it.
    if end == End::Complete {
        stopped?;
    }
    Ok(Closed { end, counts: control.state().counts, wall_s, faults, scope })
}

/// What the drive has captured. A run has its verdict without it.
fn captured(device: &mut Device) -> Option<CapturedRows> {
    device.session.accepted_capture()?;
    let rows = device.session.read_capture();
    rows.map_err(|error| device.session.line.logs.note(format!("no rows of [scope]: {error}"))).ok()
}

/// The end of a run with the drive's own names of what this bench doesn't know.
fn with_own_names(end: End, device: &mut Device) -> End {
    let line = &mut device.session.line;
    match end {
        End::DriveFault(fault) => {
            let name = line.own_name(fault.code);
            End::DriveFault(fault.named(name))
        }
        End::RuleBroken(broken) => {
            if let Some(name) = broken.rule.state().and_then(|state| line.own_name(state)) {
                line.logs.note(format!("the state of the drive is {name}"));
            }
            End::RuleBroken(broken)
        }
        end => end,
    }
}

fn link_counts(unanswered: u64, before: Traffic, session: &Session, clock: ClockName) -> LinkCounts {
    let after = session.traffic();
    let at_drive = session.line.report;
    let late = after.late - before.late;
    LinkCounts {
        frames_sent: after.frames_sent - before.frames_sent,
        frames_received: after.frames_received - before.frames_received,
        crc_errors: after.damaged - before.damaged,
        // A late answer in lockstep exceeded a long timeout, so it counts as both lost and late.
        lost: match clock {
            ClockName::Lockstep => unanswered,
            ClockName::RealTime => unanswered.saturating_sub(late),
        },
        late,
        resumes: 0,
        damaged_at_drive: at_drive.map_or(0, |report| report.damaged.into()),
        overruns_at_drive: at_drive.map_or(0, |report| report.overruns.into()),
    }
}
