//! A power stage that follows a drive.

use crate::power_stage::{Modulation, PowerStageFault};

/// The outputs to a motor.
pub trait PowerStage {
    /// Switches the outputs on, at no torque, with this modulation.
    fn enable(&mut self, modulation: &Modulation);

    /// Commands a torque in N m, within the limit that [`Modulation::check`] has allowed, at a speed of the motor in rad/s. Never switches the
    /// outputs on.
    fn apply(&mut self, torque_nm: f32, speed_rad_s: f32);

    /// Switches the outputs off. Calls may be repeated.
    fn disable(&mut self);

    /// The present fault; also one that passed since the last call.
    fn fault(&mut self) -> Option<PowerStageFault>;
}

/// What the drive commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StageCommand<'run> {
    /// Outputs off.
    Off,
    /// A torque.
    Torque {
        /// Torque in N m.
        torque_nm: f32,
        /// Speed of the motor in rad/s.
        speed_rad_s: f32,
        /// Modulation of the run.
        modulation: &'run Modulation,
    },
}

/// A power stage that follows a drive.
pub struct Actuator<S> {
    stage: S,
    is_on: bool,
}

impl<S: PowerStage> Actuator<S> {
    /// A stage that is off.
    pub fn new(mut stage: S) -> Self {
        stage.disable();
        Self { stage, is_on: false }
    }

    /// Applies what the drive commands. To be called after every call of the drive that may change its state.
    pub fn follow(&mut self, command: StageCommand<'_>) {
        match command {
            StageCommand::Off => {
                self.stage.disable();
                self.is_on = false;
            }
            StageCommand::Torque { torque_nm, speed_rad_s, modulation } => {
                // Once in a run: a stage that a fault has switched off stays off until the drive has seen the fault.
                if !self.is_on {
                    self.stage.enable(modulation);
                    self.is_on = true;
                }
                self.stage.apply(torque_nm, speed_rad_s);
            }
        }
    }

    /// See [`PowerStage::fault`].
    pub fn fault(&mut self) -> Option<PowerStageFault> {
        self.stage.fault()
    }

    /// The stage.
    pub fn stage(&self) -> &S {
        &self.stage
    }

    /// The stage, besides the commands of the drive.
    pub fn stage_mut(&mut self) -> &mut S {
        &mut self.stage
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::power_stage::tests::AMPLIFIER;

    /// Records the calls.
    #[derive(Default)]
    struct Recorder(Vec<&'static str>);

    impl PowerStage for Recorder {
        fn enable(&mut self, _: &Modulation) {
            self.0.push("enable");
        }
        fn apply(&mut self, _: f32, _: f32) {
            self.0.push("apply");
        }
        fn disable(&mut self) {
            self.0.push("disable");
        }
        fn fault(&mut self) -> Option<PowerStageFault> {
            None
        }
    }

    #[test]
    fn a_stage_is_enabled_once_in_a_run_and_disabled_at_its_end() {
        let mut actuator = Actuator::new(Recorder::default());
        let on = StageCommand::Torque { torque_nm: 1.0, speed_rad_s: 0.0, modulation: &AMPLIFIER };
        for command in [on, on, StageCommand::Off, on] {
            actuator.follow(command);
        }
        assert_eq!(actuator.stage().0, ["disable", "enable", "apply", "apply", "disable", "enable", "apply"]);
    }
}
