//! When each fault begins and ends: the log of it, and faults of the drive itself.

use std::time::{Duration, Instant};

use serde::Serialize;

use super::Schedule;
use super::link::LinkFaults;
use crate::device::Device;
use crate::scenario::Scenario;
use crate::scenario::fault::{Fault, FaultKind, Place};
use crate::session::SessionError;

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

/// A fault that has been there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaultRecord {
    /// What it is.
    pub kind: &'static str,
    /// The step in which it began.
    pub step: u32,
    /// The first step without it; `None` if it was there to the end. A cut and a hang last by the clock on the wall.
    pub until_step: Option<u32>,
    /// Frames it hit, of a fault of the link.
    pub frames: Option<u64>,
}

/// The timeline of a run.
pub struct Timeline {
    faults: Vec<Planned>,
    /// The first step in which something begins or ends again.
    next: u32,
    link: Option<LinkFaults>,
}

struct Planned {
    name: &'static str,
    kind: FaultKind,
    schedule: Schedule,
    /// How long it lasts by the clock on the wall, if it goes by that: while a drive hangs or is cut off there may be no
    /// steps.
    lasts: Option<Duration>,
    /// When it will be over by that clock, while it is there.
    over_at: Option<Instant>,
    fired: Option<FaultRecord>,
}

impl Planned {
    fn new(fault: &Fault, schedule: Schedule) -> Self {
        let by_the_wall = matches!(fault.kind, FaultKind::LinkCut {} | FaultKind::DeviceHang {});
        let lasts = fault.for_s.filter(|_| by_the_wall).map(Duration::from_secs_f64);
        Self { name: fault.name, kind: fault.kind, schedule, lasts, over_at: None, fired: None }
    }

    fn hangs(&self) -> bool {
        self.kind == FaultKind::DeviceHang {} && self.over_at.is_some()
    }

    fn is_over(&self, step: u32) -> bool {
        if self.lasts.is_some() { self.over_at.is_none() } else { step >= self.schedule.until }
    }
}

impl Timeline {
    /// The timeline of a scenario, on a device on which all of it can happen.
    ///
    /// # Errors
    /// The device does not support one of the faults.
    pub fn new(
        scenario: &Scenario,
        device: &Device,
        link: Option<LinkFaults>,
    ) -> Result<Self, UnsupportedFault> {
        for fault in &scenario.faults {
            if let Some(reason) = unsupported(&fault.kind, device, link.as_ref()) {
                return Err(UnsupportedFault { kind: fault.name, at_s: fault.at_s, reason });
            }
        }
        let planned = |fault| Planned::new(fault, Schedule::of(fault, &scenario.run));
        Ok(Self {
            faults: scenario.faults.iter().map(planned).collect(),
            next: if scenario.faults.is_empty() { u32::MAX } else { 0 },
            link,
        })
    }

    /// A step begins.
    ///
    /// # Errors
    /// The line broke while the drive was to be reset.
    pub fn begin(&mut self, step: u32, device: &mut Device) -> Result<(), SessionError> {
        if let Some(link) = &self.link {
            link.set_step(Some(step));
        }
        self.revive(device);
        if step < self.next {
            return Ok(());
        }
        for fault in &mut self.faults {
            if fault.fired.is_none() && fault.schedule.contains(step) {
                fault.fired = Some(FaultRecord { kind: fault.name, step, until_step: None, frames: None });
                match fault.kind {
                    FaultKind::DeviceReset {} => device.session.reset_by_surprise()?,
                    FaultKind::DeviceHang {} => device.host().suspend(),
                    _ => {}
                }
                fault.over_at = fault.lasts.map(|lasts| device.session.now() + lasts);
            }
            if fault.is_over(step)
                && let Some(fired) = &mut fault.fired
            {
                fired.until_step.get_or_insert(step);
            }
        }
        let edges = self.faults.iter().flat_map(|fault| [fault.schedule.from, fault.schedule.until]);
        let edge = edges.filter(|edge| *edge > step).min().unwrap_or(u32::MAX);
        let by_the_wall = self.faults.iter().any(|fault| fault.over_at.is_some());
        self.next = if by_the_wall { step + 1 } else { edge };
        Ok(())
    }

    /// Lets a drive go on that has hung for its time. Asked in every step, and while a lost drive is waited for.
    pub fn revive(&mut self, device: &mut Device) {
        for fault in self.faults.iter_mut().filter(|fault| fault.over_at.is_some()) {
            let hangs = fault.hangs();
            if fault.over_at.take_if(|over_at| *over_at <= device.session.now()).is_some() && hangs {
                device.host().resume();
            }
        }
    }

    /// The line is as it should be while the bench talks to the drive outside the loop.
    pub fn pause(&self) {
        if let Some(link) = &self.link {
            link.set_step(None);
        }
    }

    /// The run is over: nothing is wrong any more. Returns what was.
    pub fn end(&mut self, device: &Device) -> Vec<FaultRecord> {
        self.pause();
        if self.faults.iter().any(Planned::hangs) {
            device.host().resume();
        }
        let fired = self.faults.iter().enumerate().filter_map(|(number, fault)| {
            let on_link = fault.kind.place() == Place::Link;
            let frames = self.link.as_ref().filter(|_| on_link).map(|link| link.hits(number));
            Some(FaultRecord { frames, ..fault.fired.clone()? })
        });
        fired.collect()
    }
}

fn unsupported(kind: &FaultKind, device: &Device, link: Option<&LinkFaults>) -> Option<&'static str> {
    match kind.place() {
        Place::Link if link.is_none() => {
            Some("this line was opened without faults on it: open the device with the scenario's faults")
        }
        Place::Device if *kind == (FaultKind::DeviceHang {}) && !device.host().can_suspend() => Some(
            "only a drive that the bench runs can be suspended: use --device inproc, native or qemu, or link-stall",
        ),
        _ => None,
    }
}
