//! Faults of the motor: between the torque the drive commands and the torque the plant receives.

use std::collections::VecDeque;

use super::schedule::{FaultGroups, Schedule};
use crate::scenario::Scenario;
use crate::scenario::fault::MotorFault;

/// The faults of the motor with their state.
pub struct MotorFaults {
    faults: Vec<(Schedule, MotorFault)>,
    /// Commanded torques, newest first; one more than all delays add up to.
    commanded_nm: VecDeque<f32>,
}

impl MotorFaults {
    /// The motor faults of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let faults = FaultGroups::of(scenario).motor;
        let capacity = faults.iter().map(|(_, fault)| delay_steps(fault)).sum::<usize>() + 1;
        Self { faults, commanded_nm: std::iter::repeat_n(0.0, capacity).collect() }
    }

    /// The motor's torque for a commanded one. Delays act first, since they delay the command; all other faults act in the
    /// scenario's order.
    pub fn apply(&mut self, step: u32, torque_nm: f32) -> f32 {
        self.commanded_nm.pop_back();
        self.commanded_nm.push_front(torque_nm);
        let active =
            || self.faults.iter().filter(|(schedule, _)| schedule.contains(step)).map(|(_, fault)| fault);
        let delayed_nm = self.commanded_nm[active().map(delay_steps).sum::<usize>()];
        active().fold(delayed_nm, |torque_nm, fault| match *fault {
            MotorFault::Saturation { limit_nm } => torque_nm.clamp(-limit_nm as f32, limit_nm as f32),
            MotorFault::Gain { gain } => torque_nm * gain as f32,
            MotorFault::Dead {} => 0.0,
            MotorFault::Delay { .. } => torque_nm,
        })
    }
}

fn delay_steps(fault: &MotorFault) -> usize {
    if let MotorFault::Delay { steps } = *fault { steps as usize } else { 0 }
}
