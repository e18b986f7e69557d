//! The control steps in which a fault is active.

use crate::scenario::Scenario;
use crate::scenario::fault::{
    EncoderFault, FaultDuration, FaultKind, FrameFault, InjectedFault, LinkFault, MotorFault, PlantFault,
    Side, Way,
};
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

/// Faults with their index in the scenario, which chooses a random stream or a counter.
type Scheduled<T> = Vec<(usize, Schedule, T)>;

/// The faults of a scenario by the group that applies them. Faults of the drive are applied by the timeline.
#[derive(Default)]
pub(super) struct FaultGroups {
    pub frames: Scheduled<(FrameFault, Way)>,
    pub connection: Scheduled<LinkFault>,
    pub encoders: Scheduled<(EncoderFault, Side)>,
    pub motor: Vec<(Schedule, MotorFault)>,
    pub plant: Vec<(Schedule, PlantFault)>,
}

impl FaultGroups {
    pub fn of(scenario: &Scenario) -> Self {
        let mut groups = Self::default();
        for (index, fault) in scenario.faults.iter().enumerate() {
            let schedule = Schedule::of(fault, &scenario.run);
            match fault.kind {
                FaultKind::Frame { fault, way } => groups.frames.push((index, schedule, (fault, way))),
                FaultKind::Link(fault) => groups.connection.push((index, schedule, fault)),
                FaultKind::Encoder { fault, side } => groups.encoders.push((index, schedule, (fault, side))),
                FaultKind::Motor(fault) => groups.motor.push((schedule, fault)),
                FaultKind::Plant(fault) => groups.plant.push((schedule, fault)),
                FaultKind::Device(_) => {}
            }
        }
        groups
    }
}
