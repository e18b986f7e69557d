//! The middleware: impairments of both directions, and cuts of the connection.

use std::time::{Duration, Instant};

use lashloop_link::{Link, LinkError};

use super::impairment::Impairment;
use super::link_faults::LinkFaults;
use crate::fault::schedule::FaultGroups;
use crate::scenario::Scenario;
use crate::scenario::fault::LinkFault;

impl LinkFaults {
    /// Puts the faults of a scenario on a link.
    #[must_use]
    pub fn wrap(&self, link: Box<dyn Link>, scenario: &Scenario) -> Box<dyn Link> {
        let cuts = FaultGroups::of(scenario).connection.into_iter();
        let cuts = cuts.map(|(index, schedule, fault)| match fault {
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
    /// In the link's time: while the link is cut there may be no steps.
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
        let (step, now) = (self.shared.step(), self.link.now());
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
        let (step, now) = (self.shared.step(), self.link.now());
        while let Some(frame) = self.to_drive.next_due(step, now) {
            self.link.send(&frame)?;
        }
        Ok(())
    }
}

impl Link for FaultyLink {
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
