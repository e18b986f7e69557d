//! The timeline of a run: begin and end of each fault, and the faults that strike the drive itself.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use super::link::LinkFaults;
use super::schedule::Schedule;
use crate::device::Device;
use crate::scenario::Scenario;
use crate::scenario::fault::{DeviceFault, FaultDuration, FaultKind, InjectedFault};
use lashloop_session::SessionError;
use serde::{Deserialize, Serialize};

/// A fault that can't be injected on this device.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("fault {kind} at {at_s} s can't be applied here: {reason}")]
pub struct UnsupportedFault {
    /// Name of its kind.
    pub kind: &'static str,
    /// When it was to begin.
    pub at_s: f64,
    /// Why, and what to do.
    pub reason: &'static str,
}

/// A fault that was injected.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultRecord {
    /// Name of its kind.
    pub kind: Cow<'static, str>,
    /// The step in which it began.
    pub step: u32,
    /// The first step after it; `None` if it lasted to the end. A cut and a hang last in the link's time.
    pub until_step: Option<u32>,
    /// Frames hit, by a fault of the link.
    pub frames: Option<u64>,
}

/// The timeline of a run.
pub struct Timeline {
    faults: Vec<TimedFault>,
    link: Option<LinkFaults>,
}

/// The start or the end of an injected fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultEdge {
    /// Number of the fault in the scenario, from 0.
    pub number: usize,
    /// Name of its kind.
    pub kind: &'static str,
    /// Its first step, or the first step after it.
    pub step: u32,
    /// Begin or end.
    pub begins: bool,
}

struct TimedFault {
    kind: FaultKind,
    schedule: Schedule,
    /// For a fault that lasts in the link's time.
    lasts: Option<Duration>,
    progress: Progress,
    /// Begin, then end: how many of them [`Timeline::next_edge`] has passed on.
    edges_passed_on: u8,
}

enum Progress {
    Pending,
    Active {
        since: u32,
        /// For a fault that lasts in the link's time.
        over_at: Option<Instant>,
    },
    Over {
        since: u32,
        /// `None` until the first step after a fault that ended between steps.
        until: Option<u32>,
    },
}

impl TimedFault {
    fn new(fault: &InjectedFault, schedule: Schedule) -> Self {
        let for_s = fault.for_s.filter(|_| fault.kind.duration() == FaultDuration::WallClock);
        let lasts = for_s.map(Duration::from_secs_f64);
        Self { kind: fault.kind, schedule, lasts, progress: Progress::Pending, edges_passed_on: 0 }
    }

    /// When it is over, of a fault that is active and lasts in the link's time.
    fn over_at(&self) -> Option<Instant> {
        if let Progress::Active { over_at, .. } = self.progress { over_at } else { None }
    }

    /// A step begins.
    fn advance(&mut self, step: u32, device: &mut Device) -> Result<(), SessionError> {
        match &mut self.progress {
            Progress::Pending if self.schedule.contains(step) => {
                self.progress = Progress::Active { since: step, over_at: None };
                strike(self.kind, device)?;
                let over_at = self.lasts.map(|lasts| device.session.line.now() + lasts);
                self.progress = Progress::Active { since: step, over_at };
            }
            Progress::Active { since, over_at: None }
                if self.schedule.until.is_some_and(|end| step >= end) =>
            {
                self.progress = Progress::Over { since: *since, until: Some(step) };
            }
            Progress::Over { until, .. } => {
                until.get_or_insert(step);
            }
            Progress::Pending | Progress::Active { .. } => {}
        }
        Ok(())
    }

    /// Step of the next edge to pass on, and whether the fault begins there.
    fn next_edge(&mut self) -> Option<(u32, bool)> {
        let edge = match (self.edges_passed_on, &self.progress) {
            (0, Progress::Active { since, .. } | Progress::Over { since, .. }) => (*since, true),
            (1, Progress::Over { until: Some(until), .. }) => (*until, false),
            _ => return None,
        };
        self.edges_passed_on += 1;
        Some(edge)
    }

    fn record(&self, frames: Option<u64>) -> Option<FaultRecord> {
        let (step, until_step) = match self.progress {
            Progress::Pending => return None,
            Progress::Active { since, .. } => (since, None),
            Progress::Over { since, until } => (since, until),
        };
        Some(FaultRecord { kind: self.kind.name().into(), step, until_step, frames })
    }
}

impl Timeline {
    /// The timeline of a scenario on a device.
    ///
    /// # Errors
    /// The device doesn't support one of the faults.
    pub fn new(
        scenario: &Scenario,
        device: &Device,
        link: Option<LinkFaults>,
    ) -> Result<Self, UnsupportedFault> {
        for fault in &scenario.faults {
            if let Some(reason) = unsupported(fault.kind, device, link.as_ref()) {
                return Err(UnsupportedFault { kind: fault.kind.name(), at_s: fault.at_s, reason });
            }
        }
        let timed = |fault| TimedFault::new(fault, Schedule::of(fault, &scenario.run));
        Ok(Self { faults: scenario.faults.iter().map(timed).collect(), link })
    }

    /// Begins a step. The exchange of the step finds a drive that is lost here.
    ///
    /// # Errors
    /// The link failed while the drive was to be reset.
    pub fn begin(&mut self, step: u32, device: &mut Device) -> Result<(), SessionError> {
        self.advance(step, device).or_else(|source| if source.is_loss() { Ok(()) } else { Err(source) })
    }

    fn advance(&mut self, step: u32, device: &mut Device) -> Result<(), SessionError> {
        if let Some(link) = &self.link {
            link.set_step(Some(step));
        }
        self.revive(device);
        self.faults.iter_mut().try_for_each(|fault| fault.advance(step, device))
    }

    /// Ends faults whose time is over. To be called in every step, and while a lost drive is awaited.
    pub fn revive(&mut self, device: &mut Device) {
        for fault in &mut self.faults {
            if let Progress::Active { since, over_at: Some(over_at) } = fault.progress
                && over_at <= device.session.line.now()
            {
                fault.progress = Progress::Over { since, until: None };
                heal(fault.kind, device);
            }
        }
    }

    /// The next begin or end of a fault that this has not returned yet.
    pub fn next_edge(&mut self) -> Option<FaultEdge> {
        self.faults.iter_mut().enumerate().find_map(|(number, fault)| {
            let (step, begins) = fault.next_edge()?;
            Some(FaultEdge { number, kind: fault.kind.name(), step, begins })
        })
    }

    /// Suspends the faults of the link for an exchange with the drive outside the loop.
    pub fn pause(&self) {
        if let Some(link) = &self.link {
            link.set_step(None);
        }
    }

    /// Ends all faults with the run, and returns their log.
    pub fn end(&mut self, device: &Device) -> Vec<FaultRecord> {
        self.pause();
        for fault in self.faults.iter().filter(|fault| fault.over_at().is_some()) {
            heal(fault.kind, device);
        }
        let records = self.faults.iter().enumerate().filter_map(|(index, fault)| {
            let link = self.link.as_ref().filter(|_| fault.kind.strikes_link());
            fault.record(link.map(|link| link.hits(index)))
        });
        records.collect()
    }
}

/// Begins a fault of the drive. Every other fault takes effect where it strikes.
fn strike(kind: FaultKind, device: &mut Device) -> Result<(), SessionError> {
    let FaultKind::Device(fault) = kind else { return Ok(()) };
    match fault {
        DeviceFault::Reset {} => return device.session.reset_by_surprise(),
        DeviceFault::Hang {} => device.connection.host.set_suspended(true),
    }
    Ok(())
}

/// Ends a fault of the drive that lasts in the link's time.
fn heal(kind: FaultKind, device: &Device) {
    let FaultKind::Device(fault) = kind else { return };
    match fault {
        DeviceFault::Hang {} => device.connection.host.set_suspended(false),
        DeviceFault::Reset {} => {}
    }
}

fn unsupported(kind: FaultKind, device: &Device, link: Option<&LinkFaults>) -> Option<&'static str> {
    match kind {
        FaultKind::Frame { .. } | FaultKind::Link(_) => link
            .is_none()
            .then_some("this link was opened without fault injection: open the device for this scenario"),
        FaultKind::Device(DeviceFault::Hang {}) => (!device.connection.host.is_started()).then_some(
            "only a drive that the bench runs can be suspended: use --device inproc, native or qemu, or link-stall",
        ),
        FaultKind::Device(DeviceFault::Reset {})
        | FaultKind::Encoder { .. }
        | FaultKind::Motor(_)
        | FaultKind::Plant(_) => None,
    }
}
