//! From a scenario and a device to a verdict.

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use super::control_loop::{ControlLoop, Sink};
use super::real_time::{self, RealTime, Ring};
use super::simulator::Simulator;
use super::step_sink::{StepRecorder, Watcher};
use super::{End, Outcome, RunError, lockstep, setup};
use crate::device::Device;
use crate::fault::log::FaultRecord;
use crate::fault::timeline::Timeline;
use crate::scenario::Scenario;
use crate::session::{Session, Traffic};
use crate::timing::ClockName;
use crate::verdict::{Judgement, LinkCounts};

/// What paces a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Clock {
    /// The plant waits for the drive and the drive for the plant.
    #[default]
    Lockstep,
    /// The clock on the wall.
    RealTime(RealTime),
}

impl Clock {
    /// Which of them.
    #[must_use]
    pub fn name(&self) -> ClockName {
        match self {
            Self::Lockstep => ClockName::Lockstep,
            Self::RealTime(_) => ClockName::RealTime,
        }
    }
}

/// Runs a scenario on a device and judges it.
///
/// # Errors
/// The scenario does not fit the drive, the device or the link failed, or the record could not be written. The watcher
/// has seen every row up to then.
pub fn run(
    scenario: &Scenario,
    device: &mut Device,
    clock: Clock,
    watcher: &mut dyn Watcher,
) -> Result<Outcome, RunError> {
    let simulator = Simulator::new(scenario)?;
    let timeline = Timeline::new(scenario, device)?;
    setup::set_up(device, scenario, clock.name())?;
    let watchdog = match clock {
        Clock::Lockstep => None,
        Clock::RealTime(_) => Some(setup::watchdog(device)?),
    };
    let before = device.session.traffic();
    let mut keeper = StepRecorder::new(scenario, clock.name(), watcher);
    let (closed, refused) = match clock {
        Clock::Lockstep => {
            let control =
                ControlLoop::new(scenario, simulator, timeline, clock.name(), watchdog, &mut keeper);
            (
                to_the_end(control, device, |control, device| lockstep::close(control, scenario, device))?,
                Vec::new(),
            )
        }
        Clock::RealTime(options) => {
            in_real_time(scenario, simulator, timeline, watchdog, device, &options, &mut keeper)?
        }
    };
    let Closed { end, steps, unanswered, resumes, wall_s, faults } = closed;
    if matches!(end, End::Diverged(_)) {
        keeper.measurement.diverged();
    }
    let link = LinkCounts { resumes, ..link_counts(unanswered, before, &device.session, clock.name()) };
    let timing = keeper.timings.report(refused);
    let metrics = keeper.measurement.metrics();
    let mut judgement = Judgement::new(&scenario.expectations, &metrics, &scenario.allow, &link, &timing);
    judgement.cap(end.verdict());
    Ok(Outcome {
        judgement,
        end,
        metrics,
        link,
        timing,
        faults,
        steps,
        simulated_s: steps as f64 * scenario.run.control_period_s(),
        wall_s,
        torque_sha256: keeper.digest.finish(),
        logs: device.session.take_logs(),
    })
}

/// A loop that has ended, and a drive that has been stopped.
struct Closed {
    end: End,
    steps: u64,
    unanswered: u64,
    resumes: u64,
    wall_s: f64,
    faults: Vec<FaultRecord>,
}

/// The loop on its own thread, the keeper on this one.
fn in_real_time(
    scenario: &Scenario,
    simulator: Simulator,
    timeline: Timeline,
    watchdog: Option<Duration>,
    device: &mut Device,
    options: &RealTime,
    keeper: &mut StepRecorder<'_>,
) -> Result<(Closed, Vec<String>), RunError> {
    let stop = AtomicBool::new(false);
    let (ring, mut steps) = Ring::new(&stop);
    let mut kept = Ok(());
    let mut keeper = keeper;
    let work = || {
        let refused = real_time::obtain(options);
        let control = ControlLoop::new(scenario, simulator, timeline, ClockName::RealTime, watchdog, ring);
        let closed = to_the_end(control, device, |control, device| {
            real_time::close(control, scenario, device, options.spin)
        });
        (closed, refused)
    };
    let look = || {
        if kept.is_ok() {
            kept = real_time::drain(&mut steps, &mut keeper, &stop);
        }
    };
    let (closed, refused) = real_time::run_with_drain(work, look)?;
    // What could not be kept is why the loop was stopped.
    kept?;
    Ok((closed?, refused))
}

fn to_the_end<'a, S: Sink>(
    mut control: ControlLoop<'a, S>,
    device: &mut Device,
    close: impl FnOnce(&mut ControlLoop<'a, S>, &mut Device) -> Result<End, RunError>,
) -> Result<Closed, RunError> {
    // Last of all, because the drive's watchdog runs from here on.
    if let Err(source) = device.session.start() {
        // It may be armed, or even running if only its answer was lost.
        device.session.abandon();
        return Err(setup::refused_start(device, source));
    }
    let started = Instant::now();
    let end = close(&mut control, device);
    let wall_s = started.elapsed().as_secs_f64();
    let faults = control.end_faults(device);
    // The last telemetry comes before the answer to the stop, and the last row waits for it.
    let stopped = match &end {
        Ok(end) if end.leaves_a_session() => {
            // On a line that has lost samples a half frame may stand before the stop.
            let cleared = if control.unanswered() > 0 { device.session.end_frame() } else { Ok(()) };
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
    control.finish(device)?;
    let end = end?;
    // A run that was cut short says so, whether the drive could still be told or not.
    if end == End::Complete {
        stopped?;
    }
    let (steps, unanswered, resumes) = (control.steps(), control.unanswered(), control.resumes());
    Ok(Closed { end, steps, unanswered, resumes, wall_s, faults })
}

fn link_counts(unanswered: u64, before: Traffic, session: &Session, clock: ClockName) -> LinkCounts {
    let after = session.traffic();
    let at_drive = session.line_report();
    let late = after.late - before.late;
    LinkCounts {
        frames_sent: after.frames_sent - before.frames_sent,
        frames_received: after.frames_received - before.frames_received,
        crc_errors: after.damaged - before.damaged,
        // In lockstep an answer is waited for so long that one which comes after all is worth a count of its own.
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
