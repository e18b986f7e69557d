//! Faults of the motor: between the torque the drive gives and the torque the plant gets.

use std::collections::VecDeque;

use super::{Schedule, at_place};
use crate::scenario::Scenario;
use crate::scenario::fault::{FaultKind, Place};

/// The faults of the motor, with what they remember.
pub struct ActuatorFaults {
    faults: Vec<(Schedule, FaultKind)>,
    /// The latest torques, newest first, as many as the longest delay needs.
    latest_nm: VecDeque<f32>,
}

impl ActuatorFaults {
    /// Those of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let faults: Vec<_> =
            at_place(scenario, Place::Actuator).map(|(_, schedule, kind)| (schedule, kind)).collect();
        let longest = faults.iter().map(|(_, kind)| match kind {
            FaultKind::TorqueDelay { steps } => *steps as usize,
            _ => 0,
        });
        let room = longest.max().unwrap_or(0) + 1;
        Self { faults, latest_nm: std::iter::repeat_n(0.0, room).collect() }
    }

    /// What the motor makes of a torque.
    pub fn apply(&mut self, step: u32, torque_nm: f32) -> f32 {
        self.latest_nm.pop_back();
        self.latest_nm.push_front(torque_nm);
        let mut given_nm = torque_nm;
        for (schedule, kind) in &self.faults {
            if !schedule.contains(step) {
                continue;
            }
            given_nm = match *kind {
                FaultKind::TorqueSaturation { limit_nm } => given_nm.clamp(-limit_nm as f32, limit_nm as f32),
                FaultKind::TorqueGain { gain } => given_nm * gain as f32,
                FaultKind::TorqueDelay { steps } => self.latest_nm[steps as usize],
                FaultKind::TorqueDead {} => 0.0,
                _ => given_nm,
            };
        }
        given_nm
    }
}
