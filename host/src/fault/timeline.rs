//! When each fault begins and ends: the log of it, and faults of the drive itself.

use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde::Serialize;

use super::Schedule;
use super::link::LinkFaults;
use crate::device::{Device, DeviceChoice};
use crate::run::RunError;
use crate::scenario::Scenario;
use crate::scenario::fault::{Fault, FaultKind, Place};
use crate::session::SessionError;

/// A fault that has been there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fired {
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
    faults: Vec<(Schedule, FaultKind)>,
    fired: Vec<Option<Fired>>,
    names: Vec<&'static str>,
    /// The first step in which something begins or ends again.
    next: u32,
    /// When each fault that is there now will be over, if that goes by the clock on the wall: while a drive hangs or is cut
    /// off there may be no steps.
    over_at: Vec<Option<Instant>>,
    /// How long each of those lasts.
    lasts: Vec<Option<Duration>>,
    link: Option<LinkFaults>,
}

impl Timeline {
    /// The timeline of a scenario, on a device on which all of it can happen.
    ///
    /// # Errors
    /// [`RunError::Fault`] names a fault that can't be applied there.
    pub fn new(scenario: &Scenario, device: &Device) -> Result<Self, RunError> {
        for fault in &scenario.faults {
            if let Some(reason) = impossible(&fault.kind, device) {
                return Err(RunError::Fault { kind: fault.name, at_s: fault.at_s, reason });
            }
        }
        let schedule = |fault| Schedule::of(fault, &scenario.run);
        Ok(Self {
            faults: scenario.faults.iter().map(|fault| (schedule(fault), fault.kind)).collect(),
            fired: vec![None; scenario.faults.len()],
            names: scenario.faults.iter().map(|fault| fault.name).collect(),
            next: if scenario.faults.is_empty() { u32::MAX } else { 0 },
            over_at: vec![None; scenario.faults.len()],
            lasts: scenario.faults.iter().map(wall_time).collect(),
            link: device.link_faults().cloned(),
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
        for (number, (schedule, kind)) in self.faults.iter().enumerate() {
            let fired = &mut self.fired[number];
            if fired.is_none() && schedule.contains(step) {
                *fired = Some(Fired { kind: self.names[number], step, until_step: None, frames: None });
                match kind {
                    FaultKind::DeviceReset {} => device.session.reset_by_surprise()?,
                    FaultKind::DeviceHang {} => signal(device, Signal::STOP),
                    _ => {}
                }
                self.over_at[number] = self.lasts[number].map(|lasts| Instant::now() + lasts);
            }
            let is_over = match self.lasts[number] {
                Some(_) => self.over_at[number].is_none(),
                None => step >= schedule.until,
            };
            if let Some(fired) = fired
                && is_over
            {
                fired.until_step.get_or_insert(step);
            }
        }
        let edges = self.faults.iter().flat_map(|(schedule, _)| [schedule.from, schedule.until]);
        let edge = edges.filter(|edge| *edge > step).min().unwrap_or(u32::MAX);
        self.next = if self.over_at.iter().any(Option::is_some) { step + 1 } else { edge };
        Ok(())
    }

    /// Lets a drive go on that has hung for its time. Asked in every step, and while a lost drive is waited for.
    pub fn revive(&mut self, device: &Device) {
        if self.over_at.iter().all(Option::is_none) {
            return;
        }
        let now = Instant::now();
        for (over_at, (_, kind)) in self.over_at.iter_mut().zip(&self.faults) {
            if over_at.take_if(|over_at| *over_at <= now).is_some() && *kind == (FaultKind::DeviceHang {}) {
                signal(device, Signal::CONT);
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
    pub fn end(&mut self, device: &Device) -> Vec<Fired> {
        self.pause();
        for (over_at, (_, kind)) in self.over_at.iter().zip(&self.faults) {
            if over_at.is_some() && *kind == (FaultKind::DeviceHang {}) {
                signal(device, Signal::CONT);
            }
        }
        let fired = self.fired.iter().enumerate().filter_map(|(number, fired)| {
            let mut fired = fired.clone()?;
            let on_link = self.faults[number].1.place() == Place::Link;
            fired.frames = self.link.as_ref().filter(|_| on_link).map(|link| link.hits(number));
            Some(fired)
        });
        fired.collect()
    }
}

/// How long a fault lasts that goes by the clock on the wall.
fn wall_time(fault: &Fault) -> Option<Duration> {
    let by_the_wall = matches!(fault.kind, FaultKind::LinkCut {} | FaultKind::DeviceHang {});
    fault.for_s.filter(|_| by_the_wall).map(Duration::from_secs_f64)
}

fn impossible(kind: &FaultKind, device: &Device) -> Option<&'static str> {
    match kind.place() {
        Place::Link if device.link_faults().is_none() => {
            Some("this line was opened without faults on it: open the device with the scenario's faults")
        }
        Place::Device if *kind == (FaultKind::DeviceHang {}) && device.process().is_none() => {
            Some(if *device.choice() == DeviceChoice::InProcess {
                "the drive is in the bench's own process, which would hang as well: use --device native or qemu"
            } else {
                "only a process that the bench started can be stopped: use --device native or qemu, or link-stall"
            })
        }
        _ => None,
    }
}

fn signal(device: &Device, signal: Signal) {
    if let Some(pid) = device.process().and_then(|process| Pid::from_raw(process.id().cast_signed())) {
        // It may have ended by itself, which the line is about to tell.
        let _ = kill_process(pid, signal);
    }
}
