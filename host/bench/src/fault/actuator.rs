//! Faults of the motor: between the torque the drive gives and the torque the plant gets.

use std::collections::VecDeque;

use super::{Schedule, at_place};
use crate::scenario::Scenario;
use crate::scenario::fault::{FaultKind, Place};

/// The faults of the motor, with what they remember.
pub struct ActuatorFaults {
    faults: Vec<(Schedule, FaultKind)>,
    /// The latest torques, newest first, as many as all delays together need.
    latest_nm: VecDeque<f32>,
}

impl ActuatorFaults {
    /// Those of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let faults: Vec<_> =
            at_place(scenario, Place::Actuator).map(|(_, schedule, kind)| (schedule, kind)).collect();
        let room = faults.iter().map(|(_, kind)| delay_of(kind)).sum::<usize>() + 1;
        Self { faults, latest_nm: std::iter::repeat_n(0.0, room).collect() }
    }

    /// What the motor makes of a torque. Delays come first, whatever the order in the scenario: what is delayed is what
    /// the motor was told. The others follow in their order.
    pub fn apply(&mut self, step: u32, torque_nm: f32) -> f32 {
        self.latest_nm.pop_back();
        self.latest_nm.push_front(torque_nm);
        let active =
            || self.faults.iter().filter(|(schedule, _)| schedule.contains(step)).map(|(_, kind)| kind);
        let mut given_nm = self.latest_nm[active().map(delay_of).sum::<usize>()];
        for kind in active() {
            given_nm = match *kind {
                FaultKind::TorqueSaturation { limit_nm } => given_nm.clamp(-limit_nm as f32, limit_nm as f32),
                FaultKind::TorqueGain { gain } => given_nm * gain as f32,
                FaultKind::TorqueDead {} => 0.0,
                _ => given_nm,
            };
        }
        given_nm
    }
}

fn delay_of(kind: &FaultKind) -> usize {
    match kind {
        FaultKind::TorqueDelay { steps } => *steps as usize,
        _ => 0,
    }
}
