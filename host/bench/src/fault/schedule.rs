//! The control steps in which a fault is active.

use crate::scenario::Scenario;
use crate::scenario::fault::{FaultDuration, FaultKind, InjectedFault};
use crate::scenario::sections::RunSettings;

/// The control steps in which a fault is active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule {
    /// The first step.
    pub from: u32,
    /// The first step after the fault; `None` for a fault that lasts to the end of the run.
    pub until: Option<u32>,
}

impl Schedule {
    /// The steps of a fault: its times rounded to the nearest step, and at least one step.
    #[must_use]
    pub fn of(fault: &InjectedFault, run: &RunSettings) -> Self {
        let from = run.step_at(fault.at_s);
        let steps = match fault.kind.duration() {
            FaultDuration::Momentary => Some(1),
            FaultDuration::Simulated | FaultDuration::WallClock => {
                fault.for_s.map(|for_s| run.step_at(for_s).max(1))
            }
        };
        Self { from, until: steps.map(|steps| from.saturating_add(steps)) }
    }

    /// Whether the fault is active in a step.
    #[must_use]
    pub fn contains(&self, step: u32) -> bool {
        step >= self.from && self.until.is_none_or(|until| step < until)
    }

    /// The steps at which the fault begins and ends.
    pub fn edges(&self) -> impl Iterator<Item = u32> + use<> {
        std::iter::once(self.from).chain(self.until)
    }
}

/// The faults that `select` picks, each with its index in the scenario.
pub(super) fn scheduled<T>(
    scenario: &Scenario,
    select: impl Fn(FaultKind) -> Option<T>,
) -> impl Iterator<Item = (usize, Schedule, T)> {
    let faults = scenario.faults.iter().enumerate();
    faults.filter_map(move |(index, fault)| {
        Some((index, Schedule::of(fault, &scenario.run), select(fault.kind)?))
    })
}
