//! The handle that control loop and faulty link share.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::scenario::Scenario;

/// The current step, and the frames hit so far. Clones share both.
#[derive(Clone)]
pub struct LinkFaults(Arc<Shared>);

struct Shared {
    /// One more than the current step; zero between steps, when no fault is active.
    step_plus_one: AtomicU64,
    /// Frames hit, by the fault's index in the scenario.
    hits: Vec<AtomicU64>,
}

impl LinkFaults {
    /// For the faults of a scenario; `None` if none of them strikes the link.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Option<Self> {
        let strikes_link = scenario.faults.iter().any(|fault| fault.kind.strikes_link());
        strikes_link.then(|| {
            let hits = scenario.faults.iter().map(|_| AtomicU64::new(0)).collect();
            Self(Arc::new(Shared { step_plus_one: AtomicU64::new(0), hits }))
        })
    }

    /// Frames hit by a fault, by its index in the scenario.
    #[must_use]
    pub fn hits(&self, fault: usize) -> u64 {
        self.0.hits[fault].load(Ordering::Relaxed)
    }

    /// Sets the current step; `None` suspends all faults.
    pub(in crate::fault) fn set_step(&self, step: Option<u32>) {
        let step_plus_one = step.map_or(0, |step| u64::from(step) + 1);
        self.0.step_plus_one.store(step_plus_one, Ordering::Relaxed);
    }

    pub(super) fn step(&self) -> Option<u32> {
        let step = self.0.step_plus_one.load(Ordering::Relaxed).checked_sub(1)?;
        u32::try_from(step).ok()
    }

    pub(super) fn count_hit(&self, fault: usize) {
        self.0.hits[fault].fetch_add(1, Ordering::Relaxed);
    }
}
