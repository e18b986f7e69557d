//! Faults on a timeline: what goes wrong, at which step, and the log of what did.
//!
//! A fault is a fault of the world and never a change of the drive or of the bench's own judgement. Where it acts:
//!
//! | module | on |
//! |---|---|
//! | [`sensor`] | the counts, after the encoders |
//! | [`actuator`] | the torque, before the plant |
//! | [`gears`] | the plant and what is around it |
//! | [`link`] | the frames, as a middleware of the link |
//! | [`timeline`] | the drive itself; it also keeps the log |
//!
//! What is drawn at random is drawn from the seed of the run, a stream for each fault, so a run repeats.

pub mod actuator;
pub mod link;
pub mod plant;
pub mod sensor;
pub mod timeline;

#[cfg(test)]
pub(crate) mod tests;

use lashloop_plant::random::{Pcg64Mcg, SeedableRng, uniform as draw};

use crate::scenario::Scenario;
use crate::scenario::fault::{Fault, FaultKind, Place};
use crate::scenario::sections::RunSettings;

/// The steps in which a fault is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule {
    /// The first.
    pub from: u32,
    /// The first without it.
    pub until: u32,
}

impl Schedule {
    /// The steps of a fault: its times to the nearest step, and one step at least.
    #[must_use]
    pub fn of(fault: &Fault, run: &RunSettings) -> Self {
        let from = run.step_at(fault.at_s);
        let until = match (fault.for_s, fault.kind) {
            (_, FaultKind::DeviceReset {}) => from.saturating_add(1),
            (Some(for_s), _) => from.saturating_add(run.step_at(for_s).max(1)),
            (None, _) => u32::MAX,
        };
        Self { from, until }
    }

    /// Whether the fault is there in a step.
    #[must_use]
    pub fn contains(&self, step: u32) -> bool {
        (self.from..self.until).contains(&step)
    }
}

/// The faults of one place, each with its number in the scenario.
fn at_place(scenario: &Scenario, place: Place) -> impl Iterator<Item = (usize, Schedule, FaultKind)> {
    let run = &scenario.run;
    let here = scenario.faults.iter().enumerate().filter(move |(_, fault)| fault.kind.place() == place);
    here.map(|(number, fault)| (number, Schedule::of(fault, run), fault.kind))
}

/// Apart from each other and from the noise of the encoders.
fn random_stream(scenario: &Scenario, fault: usize, way: u64) -> Pcg64Mcg {
    const STREAM: u64 = 0xd1b5_4a32_d192_ed03;
    Pcg64Mcg::seed_from_u64(scenario.run.seed ^ STREAM.wrapping_mul(2 * fault as u64 + way + 1))
}

/// Evenly below `end`, which is far below 2^32.
fn draw_below(random: &mut Pcg64Mcg, end: usize) -> usize {
    (draw(random) * end as f64) as usize
}
