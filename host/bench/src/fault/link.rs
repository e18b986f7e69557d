//! Faults of the line, as a middleware between the bench and any link.
//!
//! Frames are hit as wholes: whether one is hit, and where, is drawn once for it, whatever pieces it comes in. Held frames
//! wait in queues of fixed size; a line that would have to hold more loses the oldest.

mod impairment;

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::at_place;
use crate::link::{Link, LinkError};
use crate::scenario::Scenario;
use crate::scenario::fault::{FaultKind, Place};
use impairment::Impairment;

/// No step is under way.
const NONE: u32 = u32::MAX;

/// What loop and line share.
#[derive(Clone)]
pub struct LinkFaults(Arc<Shared>);

struct Shared {
    step: AtomicU32,
    /// Frames hit, by the number of the fault in the scenario.
    hits: Vec<AtomicU64>,
}

impl LinkFaults {
    /// For the faults of a scenario; `None` if none is on the line.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Option<Self> {
        at_place(scenario, Place::Link).next()?;
        let hits = scenario.faults.iter().map(|_| AtomicU64::new(0)).collect();
        Some(Self(Arc::new(Shared { step: AtomicU32::new(NONE), hits })))
    }

    /// Puts the faults on a line.
    #[must_use]
    pub fn wrap(&self, link: Box<dyn Link>, scenario: &Scenario) -> Box<dyn Link> {
        let cuts = at_place(scenario, Place::Link).filter(|(_, _, kind)| *kind == FaultKind::LinkCut {});
        let cuts = cuts.map(|(number, schedule, _)| {
            let for_s = scenario.faults[number].for_s.unwrap_or_default();
            Cut { number, from: schedule.from, lasts: Duration::from_secs_f64(for_s), over_at: None }
        });
        Box::new(Faulty {
            link,
            shared: self.clone(),
            to_drive: Impairment::new(scenario, true),
            to_bench: Impairment::new(scenario, false),
            cuts: cuts.collect(),
            inbox: Box::new([0; 4096]),
        })
    }

    pub(in crate::fault) fn set_step(&self, step: Option<u32>) {
        self.0.step.store(step.unwrap_or(NONE), Ordering::Relaxed);
    }

    /// Frames that a fault has hit, by its number in the scenario.
    #[must_use]
    pub fn hits(&self, fault: usize) -> u64 {
        self.0.hits[fault].load(Ordering::Relaxed)
    }

    fn step(&self) -> Option<u32> {
        Some(self.0.step.load(Ordering::Relaxed)).filter(|step| *step != NONE)
    }

    fn count(&self, fault: usize) {
        self.0.hits[fault].fetch_add(1, Ordering::Relaxed);
    }
}

struct Cut {
    number: usize,
    from: u32,
    /// In the link's time: while the line is cut there may be no steps.
    lasts: Duration,
    over_at: Option<Instant>,
}

/// A link that things go wrong on.
struct Faulty {
    link: Box<dyn Link>,
    shared: LinkFaults,
    to_drive: Impairment,
    to_bench: Impairment,
    cuts: Vec<Cut>,
    inbox: Box<[u8; 4096]>,
}

impl Faulty {
    fn check_cuts(&mut self) -> Result<(), LinkError> {
        let (step, now) = (self.shared.step(), self.link.now());
        for cut in &mut self.cuts {
            if cut.over_at.is_none() && step.is_some_and(|step| step >= cut.from) {
                cut.over_at = Some(now + cut.lasts);
                self.shared.count(cut.number);
                self.to_drive.clear();
                self.to_bench.clear();
            }
            if cut.over_at.is_some_and(|over_at| now < over_at) {
                return Err(LinkError::Disconnected);
            }
        }
        Ok(())
    }

    fn pass_on(&mut self) -> Result<(), LinkError> {
        let (step, now) = (self.shared.step(), self.link.now());
        while let Some(frame) = self.to_drive.next_due(step, now) {
            self.link.send(&frame)?;
        }
        Ok(())
    }
}

impl Link for Faulty {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.check_cuts()?;
        let now = self.link.now();
        self.to_drive.admit(bytes, &self.shared, now);
        self.pass_on()
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            self.check_cuts()?;
            self.pass_on()?;
            let (step, now) = (self.shared.step(), self.link.now());
            if let Some(frame) = self.to_bench.next_due(step, now) {
                buffer[..frame.len()].copy_from_slice(&frame);
                return Ok(frame.len());
            }
            let releases = [self.to_drive.next_release(step, now), self.to_bench.next_release(step, now)];
            let until = releases.into_iter().flatten().fold(deadline, Instant::min);
            let count = self.link.receive(&mut self.inbox[..], until)?;
            let now = self.link.now();
            self.to_bench.admit(&self.inbox[..count], &self.shared, now);
            if count == 0 && now >= deadline {
                return Ok(0);
            }
        }
    }

    fn idle(&mut self, until: Instant) -> Result<(), LinkError> {
        self.check_cuts()?;
        self.pass_on()?;
        self.link.idle(until)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.check_cuts()?;
        self.to_drive.clear();
        self.to_bench.clear();
        self.link.discard_input()
    }
}
