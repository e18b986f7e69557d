//! The power stage: from a torque to the duty of a pulse-width modulation, and what switches the bridge.
//!
//! The documented stage is a servo amplifier in torque mode, whose command input takes the duty: `offset` gives zero torque.
//! Many amplifiers take a duty near 0 or 1 for a broken wire, so the duty stays within `min` and `max`.

use crate::direction::Direction;
use crate::law::{ParameterError, ROUNDING, Real};

/// What a power stage reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerStageFault {
    /// The break input of the timer switched the outputs off.
    BreakInput = 1,
    /// The fault line of the bridge or amplifier is active.
    FaultLine = 2,
}

/// The outputs to a motor.
pub trait PowerStage {
    /// Switches the outputs on, at no torque, with this scale.
    fn enable(&mut self, scale: &DutyScale);

    /// Commands a torque in N m, within [`DutyScale::largest_torque_nm`]. Never switches the outputs on.
    fn apply(&mut self, torque_nm: f32);

    /// Switches the outputs off. Calls may be repeated.
    fn disable(&mut self);

    /// The present fault; also one that passed since the last call.
    fn fault(&mut self) -> Option<PowerStageFault>;
}

/// From a torque to a duty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DutyScale {
    /// Torque for a duty of 1 more than `offset`, in N m.
    pub nm_per_full_duty: f32,
    /// Duty of no torque, 0 to 1.
    pub offset: f32,
    /// Smallest duty of the amplifier, 0 to `offset`.
    pub min: f32,
    /// Largest duty of the amplifier, `offset` to 1.
    pub max: f32,
    /// Whether a larger duty is a positive torque.
    pub direction: Direction,
}

impl DutyScale {
    /// Checks the scale, and that every torque up to `torque_limit_nm`, in either direction, has a duty.
    ///
    /// # Errors
    /// The parameter beyond what the others allow.
    pub fn check(&self, torque_limit_nm: f32) -> Result<(), ParameterError> {
        ParameterError::at_most("duty_min", self.min, self.offset, "duty_offset")?;
        ParameterError::at_most("duty_offset", self.offset, self.max, "duty_max")?;
        let largest_nm = self.largest_torque_nm() * (1.0 + ROUNDING);
        ParameterError::at_most("torque_limit_nm", torque_limit_nm, largest_nm, "the limits of the duty")
    }

    /// Largest torque in N m that has a duty in both directions.
    #[must_use]
    pub fn largest_torque_nm(&self) -> f32 {
        let (below, above) = (self.offset - self.min, self.max - self.offset);
        self.nm_per_full_duty * if below < above { below } else { above }
    }

    /// The duty of a torque in N m, from `min` to `max`. A torque that is not finite has the duty of no torque.
    #[must_use]
    pub fn duty(&self, torque_nm: f32) -> f32 {
        if !torque_nm.is_finite() {
            return self.offset;
        }
        let duty = self.offset + self.direction.of_torque(torque_nm) / self.nm_per_full_duty;
        Real::clamp(duty, self.min, self.max)
    }
}

/// What the drive commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StageCommand {
    /// Outputs off.
    Off,
    /// A torque.
    Torque {
        /// Torque in N m.
        torque_nm: f32,
        /// Scale of the run.
        scale: DutyScale,
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
    pub fn follow(&mut self, command: StageCommand) {
        match command {
            StageCommand::Off => {
                self.stage.disable();
                self.is_on = false;
            }
            StageCommand::Torque { torque_nm, scale } => {
                // Once in a run: a stage that a fault has switched off stays off until the drive has seen the fault.
                if !self.is_on {
                    self.stage.enable(&scale);
                    self.is_on = true;
                }
                self.stage.apply(torque_nm);
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
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    /// 10 to 90 % for 8 N m in either direction.
    const SCALE: DutyScale =
        DutyScale { nm_per_full_duty: 20.0, offset: 0.5, min: 0.1, max: 0.9, direction: Direction::Forward };

    fn near(have: f32, want: f32) {
        assert!((have - want).abs() < 1e-6, "have {have}, want {want}");
    }

    #[test]
    fn the_duty_is_the_offset_plus_the_torque_over_its_scale() {
        for (torque_nm, duty) in [(0.0, 0.5), (5.0, 0.75), (-5.0, 0.25), (8.0, 0.9), (-8.0, 0.1)] {
            near(SCALE.duty(torque_nm), duty);
            let reversed = DutyScale { direction: Direction::Reverse, ..SCALE };
            near(reversed.duty(-torque_nm), duty);
        }
    }

    #[test]
    fn a_duty_stays_within_the_limits_of_the_amplifier() {
        for torque_nm in [9.0, 1e30, f32::MAX] {
            assert_eq!([SCALE.duty(torque_nm), SCALE.duty(-torque_nm)], [0.9, 0.1]);
        }
    }

    #[test]
    fn a_torque_that_is_no_number_has_the_duty_of_no_torque() {
        for torque_nm in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(SCALE.duty(torque_nm), 0.5);
        }
    }

    #[test]
    fn an_offset_off_the_middle_leaves_the_smaller_side() {
        near(DutyScale { offset: 0.4, ..SCALE }.largest_torque_nm(), 6.0);
        near(DutyScale { offset: 0.7, ..SCALE }.largest_torque_nm(), 4.0);
    }

    #[test]
    fn a_torque_limit_without_a_duty_is_rejected_by_name() {
        assert_eq!(SCALE.check(8.0), Ok(()));
        let name = |scale: DutyScale, limit| scale.check(limit).map_err(|error| error.name);
        assert_eq!(name(SCALE, 8.001), Err("torque_limit_nm"));
        assert_eq!(name(DutyScale { min: 0.6, ..SCALE }, 0.0), Err("duty_min"));
        assert_eq!(name(DutyScale { max: 0.4, ..SCALE }, 0.0), Err("duty_offset"));
    }

    #[test]
    fn rounding_rejects_no_limit_that_the_duty_just_reaches() {
        // In single precision 0.9 - 0.5 is less than 0.4.
        let scale = DutyScale { nm_per_full_duty: 50.0, ..SCALE };
        assert!(scale.largest_torque_nm() < 20.0);
        assert_eq!(scale.check(20.0), Ok(()));
    }

    /// Records the calls.
    #[derive(Default)]
    struct Recorder(Vec<&'static str>);

    impl PowerStage for Recorder {
        fn enable(&mut self, _: &DutyScale) {
            self.0.push("enable");
        }
        fn apply(&mut self, _: f32) {
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
        let on = StageCommand::Torque { torque_nm: 1.0, scale: SCALE };
        for command in [on, on, StageCommand::Off, on] {
            actuator.follow(command);
        }
        assert_eq!(actuator.stage().0, ["disable", "enable", "apply", "apply", "disable", "enable", "apply"]);
    }
}
