//! The middleware: impairments of both directions, and cuts of the connection.

use std::thread;
use std::time::{Duration, Instant};

use super::impairment::Impairment;
use super::link_faults::LinkFaults;
use crate::fault::schedule::scheduled;
use crate::link::{Link, LinkError};
use crate::scenario::Scenario;
use crate::scenario::fault::{FaultKind, LinkFault};

impl LinkFaults {
    /// Puts the faults of a scenario on a link.
    #[must_use]
    pub fn wrap(&self, link: Box<dyn Link>, scenario: &Scenario) -> Box<dyn Link> {
        let connection = |kind| if let FaultKind::Link(fault) = kind { Some(fault) } else { None };
        let cuts = scheduled(scenario, connection).map(|(index, schedule, fault)| match fault {
            LinkFault::Cut {} => {
                let for_s = scenario.faults[index].for_s.unwrap_or_default();
                Cut { index, from: schedule.from, lasts: Duration::from_secs_f64(for_s), over_at: None }
            }
        });
        Box::new(FaultyLink {
            link,
            shared: self.clone(),
            to_drive: Impairment::new(scenario, true),
            to_bench: Impairment::new(scenario, false),
            cuts: cuts.collect(),
            inbox: Box::new([0; 4096]),
        })
    }
}

struct Cut {
    index: usize,
    from: u32,
    /// Wall-clock time, since there may be no steps during the cut.
    lasts: Duration,
    /// When the cut ends; `None` before it begins.
    over_at: Option<Instant>,
}

/// A link with faults on it.
struct FaultyLink {
    link: Box<dyn Link>,
    shared: LinkFaults,
    to_drive: Impairment,
    to_bench: Impairment,
    cuts: Vec<Cut>,
    inbox: Box<[u8; 4096]>,
}

impl FaultyLink {
    fn check_cuts(&mut self) -> Result<(), LinkError> {
        let (step, now) = (self.shared.step(), Instant::now());
        for cut in &mut self.cuts {
            if cut.over_at.is_none() && step.is_some_and(|step| step >= cut.from) {
                cut.over_at = Some(now + cut.lasts);
                self.shared.count_hit(cut.index);
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
        let (step, now) = (self.shared.step(), Instant::now());
        while let Some(frame) = self.to_drive.next_due(step, now) {
            self.link.send(&frame)?;
        }
        Ok(())
    }
}

impl Link for FaultyLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.check_cuts()?;
        self.to_drive.admit(bytes, &self.shared, Instant::now());
        self.pass_on()
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            self.check_cuts()?;
            self.pass_on()?;
            let (step, now) = (self.shared.step(), Instant::now());
            if let Some(frame) = self.to_bench.next_due(step, now) {
                buffer[..frame.len()].copy_from_slice(&frame);
                return Ok(frame.len());
            }
            let releases = [self.to_drive.next_release(step, now), self.to_bench.next_release(step, now)];
            let until = releases.into_iter().flatten().fold(deadline, Instant::min);
            let count = self.link.receive(&mut self.inbox[..], until)?;
            self.to_bench.admit(&self.inbox[..count], &self.shared, Instant::now());
            if count == 0 {
                if self.to_drive.is_empty() && self.to_bench.is_empty() {
                    // The link itself has waited up to the deadline.
                    return Ok(0);
                }
                let now = Instant::now();
                if now >= deadline {
                    return Ok(0);
                }
                // An in-process drive's link never waits.
                thread::sleep(until.saturating_duration_since(now));
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
