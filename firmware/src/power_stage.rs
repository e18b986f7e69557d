//! The power stage: from a torque to the duties of a pulse-width modulation, and what switches the bridge.
//!
//! The documented stage is a servo amplifier in torque mode, whose command input takes the duty: `offset` gives zero torque.
//! Many amplifiers take a duty near 0 or 1 for a broken wire, so the duty stays within `min` and `max`. Bridges have other
//! inputs: [`StageMode`] has them.

use crate::direction::Direction;
use crate::law::{ParameterError, ROUNDING, Real};

/// What the two channels of the modulation, with their complements, mean to the power stage. Off means all outputs low in every
/// mode: no pulse, half-bridges open, a bridge with two inputs coasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StageMode {
    /// Channel 1 has the duty: the command of a servo amplifier.
    Amplifier,
    /// Channel 1 has the size of the torque, channel 2 its direction: high for a positive duty.
    PwmDirection,
    /// The channel of the direction has the size, the other one is low. The motor coasts between pulses.
    TwoPwmCoast,
    /// The channel of the direction is high, the other one is low for the size. The motor brakes between pulses.
    TwoPwmBrake,
    /// Two half-bridges, each with a channel and its complement, at the duty and at 1 minus the duty.
    Complementary,
}

impl StageMode {
    /// Whether the duty grows with the size of the torque, in either direction.
    fn is_of_size(self) -> bool {
        match self {
            Self::Amplifier | Self::Complementary => false,
            Self::PwmDirection | Self::TwoPwmCoast | Self::TwoPwmBrake => true,
        }
    }
}

crate::choices! {
    /// The mode of the power stage, as a parameter.
    pub enum StageChoice {
        /// The first mode of the board.
        Board = "board",
        /// [`StageMode::Amplifier`].
        Amplifier = "amplifier",
        /// [`StageMode::PwmDirection`].
        PwmDirection = "pwm-dir",
        /// [`StageMode::TwoPwmCoast`].
        TwoPwmCoast = "two-pwm-coast",
        /// [`StageMode::TwoPwmBrake`].
        TwoPwmBrake = "two-pwm-brake",
        /// [`StageMode::Complementary`].
        Complementary = "complementary",
    }
}

impl StageChoice {
    /// The mode, on a board with these.
    ///
    /// # Errors
    /// The board can't do it.
    pub fn on(self, board: &[StageMode]) -> Result<StageMode, ParameterError> {
        let chosen = match self {
            Self::Board => board.first().copied(),
            Self::Amplifier => Some(StageMode::Amplifier),
            Self::PwmDirection => Some(StageMode::PwmDirection),
            Self::TwoPwmCoast => Some(StageMode::TwoPwmCoast),
            Self::TwoPwmBrake => Some(StageMode::TwoPwmBrake),
            Self::Complementary => Some(StageMode::Complementary),
        };
        let (value, max) = (self as u32 as f32, 0.0);
        let other =
            ParameterError { name: "stage_mode", value, max, given_by: "the power stage of the board" };
        chosen.filter(|mode| board.contains(mode)).ok_or(other)
    }
}

/// What a power stage reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerStageFault {
    /// The break input of the timer switched the outputs off.
    BreakInput = 1,
    /// The fault line of the bridge or amplifier is active.
    FaultLine = 2,
    /// The bridge has no supply, or too little, or its driver doesn't answer.
    NoSupply = 3,
    /// A current of the bridge was too large.
    Overcurrent = 4,
    /// The bridge is too hot.
    Overtemperature = 5,
}

/// The outputs to a motor.
pub trait PowerStage {
    /// Switches the outputs on, at no torque, with this modulation.
    fn enable(&mut self, modulation: &Modulation);

    /// Commands a torque in N m, within [`Modulation::largest_torque_nm`]. Never switches the outputs on.
    fn apply(&mut self, torque_nm: f32);

    /// Switches the outputs off. Calls may be repeated.
    fn disable(&mut self);

    /// The present fault; also one that passed since the last call.
    fn fault(&mut self) -> Option<PowerStageFault>;
}

/// From a torque to the duties of both channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulation {
    /// What the channels mean.
    pub mode: StageMode,
    /// Frequency in Hz, 100 to 20,000.
    pub frequency_hz: u32,
    /// Torque for a duty of 1 more than `offset`, in N m.
    pub nm_per_full_duty: f32,
    /// Duty of no torque, 0 to 1; 0 in a mode whose duty is the size of the torque.
    pub offset: f32,
    /// Smallest duty of the stage, 0 to `offset`.
    pub min: f32,
    /// Largest duty of the stage, `offset` to 1.
    pub max: f32,
    /// Whether a larger duty is a positive torque.
    pub direction: Direction,
}

impl Modulation {
    /// Checks that every torque up to `torque_limit_nm`, in either direction, has a duty.
    ///
    /// # Errors
    /// The parameter beyond what the others allow.
    pub fn check(&self, torque_limit_nm: f32) -> Result<(), ParameterError> {
        ParameterError::at_most("duty_min", self.min, self.offset, "duty_offset")?;
        ParameterError::at_most("duty_offset", self.offset, self.max, "duty_max")?;
        // Of any other offset these stages make a torque.
        let none = match self.mode {
            StageMode::Amplifier => self.offset,
            StageMode::Complementary => 0.5,
            StageMode::PwmDirection | StageMode::TwoPwmCoast | StageMode::TwoPwmBrake => 0.0,
        };
        if Real::abs(self.offset - none) > ROUNDING {
            let (value, max) = (self.offset, none);
            return Err(ParameterError { name: "duty_offset", value, max, given_by: "stage_mode" });
        }
        let largest_nm = self.largest_torque_nm() * (1.0 + ROUNDING);
        ParameterError::at_most("torque_limit_nm", torque_limit_nm, largest_nm, "the limits of the duty")
    }

    /// Largest torque in N m that has a duty in both directions.
    #[must_use]
    pub fn largest_torque_nm(&self) -> f32 {
        let (below, above) = (self.offset - self.min, self.max - self.offset);
        let is_smaller_below = below < above && !self.mode.is_of_size();
        self.nm_per_full_duty * if is_smaller_below { below } else { above }
    }

    /// The high times of channels 1 and 2 for a torque in N m, 0 to 1. A torque that is not finite has the duty of no torque.
    #[must_use]
    pub fn channels(&self, torque_nm: f32) -> [f32; 2] {
        let torque_nm = if torque_nm.is_finite() { self.direction.of_torque(torque_nm) } else { 0.0 };
        let above_offset = torque_nm / self.nm_per_full_duty;
        let duty = Real::clamp(self.offset + above_offset, self.min, self.max);
        let size = Real::clamp(Real::abs(above_offset), 0.0, self.max);
        let of_direction =
            |this: f32, other: f32| if above_offset < 0.0 { [other, this] } else { [this, other] };
        match self.mode {
            StageMode::Amplifier => [duty, 0.0],
            StageMode::PwmDirection => [size, if above_offset < 0.0 { 0.0 } else { 1.0 }],
            StageMode::TwoPwmCoast => of_direction(size, 0.0),
            StageMode::TwoPwmBrake => of_direction(1.0, 1.0 - size),
            StageMode::Complementary => [duty, 1.0 - duty],
        }
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
        /// Modulation of the run.
        modulation: Modulation,
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
            StageCommand::Torque { torque_nm, modulation } => {
                // Once in a run: a stage that a fault has switched off stays off until the drive has seen the fault.
                if !self.is_on {
                    self.stage.enable(&modulation);
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
    const AMPLIFIER: Modulation = Modulation {
        mode: StageMode::Amplifier,
        frequency_hz: 20_000,
        nm_per_full_duty: 20.0,
        offset: 0.5,
        min: 0.1,
        max: 0.9,
        direction: Direction::Forward,
    };
    /// 95 % for 19 N m in either direction.
    const BRIDGE: Modulation =
        Modulation { mode: StageMode::PwmDirection, offset: 0.0, min: 0.0, max: 0.95, ..AMPLIFIER };

    fn near(have: f32, want: f32) {
        assert!((have - want).abs() < 1e-6, "have {have}, want {want}");
    }

    #[test]
    fn the_duty_is_the_offset_plus_the_torque_over_its_scale() {
        for (torque_nm, duty) in [(0.0, 0.5), (5.0, 0.75), (-5.0, 0.25), (8.0, 0.9), (-8.0, 0.1)] {
            near(AMPLIFIER.channels(torque_nm)[0], duty);
            let reversed = Modulation { direction: Direction::Reverse, ..AMPLIFIER };
            near(reversed.channels(-torque_nm)[0], duty);
        }
    }

    #[test]
    fn a_duty_stays_within_the_limits_of_the_amplifier() {
        for torque_nm in [9.0, 1e30, f32::MAX] {
            assert_eq!([AMPLIFIER.channels(torque_nm)[0], AMPLIFIER.channels(-torque_nm)[0]], [0.9, 0.1]);
        }
    }

    #[test]
    fn a_torque_that_is_no_number_has_the_duty_of_no_torque() {
        for torque_nm in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(AMPLIFIER.channels(torque_nm)[0], 0.5);
        }
    }

    #[test]
    fn an_offset_off_the_middle_leaves_the_smaller_side() {
        near(Modulation { offset: 0.4, ..AMPLIFIER }.largest_torque_nm(), 6.0);
        near(Modulation { offset: 0.7, ..AMPLIFIER }.largest_torque_nm(), 4.0);
    }

    #[test]
    fn a_torque_limit_without_a_duty_is_rejected_by_name() {
        assert_eq!(AMPLIFIER.check(8.0), Ok(()));
        let name = |modulation: Modulation, limit| modulation.check(limit).map_err(|error| error.name);
        assert_eq!(name(AMPLIFIER, 8.001), Err("torque_limit_nm"));
        assert_eq!(name(Modulation { min: 0.6, ..AMPLIFIER }, 0.0), Err("duty_min"));
        assert_eq!(name(Modulation { max: 0.4, ..AMPLIFIER }, 0.0), Err("duty_offset"));
    }

    #[test]
    fn rounding_rejects_no_limit_that_the_duty_just_reaches() {
        // In single precision 0.9 - 0.5 is less than 0.4.
        let modulation = Modulation { nm_per_full_duty: 50.0, ..AMPLIFIER };
        assert!(modulation.largest_torque_nm() < 20.0);
        assert_eq!(modulation.check(20.0), Ok(()));
    }

    #[test]
    fn every_mode_has_its_levels_for_either_direction_and_for_no_torque() {
        let modes = [
            (StageMode::PwmDirection, [0.25, 1.0], [0.25, 0.0], [0.0, 1.0]),
            (StageMode::TwoPwmCoast, [0.25, 0.0], [0.0, 0.25], [0.0, 0.0]),
            (StageMode::TwoPwmBrake, [1.0, 0.75], [0.75, 1.0], [1.0, 1.0]),
        ];
        for (mode, forward, backward, none) in modes {
            let bridge = Modulation { mode, ..BRIDGE };
            for (torque_nm, want) in [(5.0, forward), (-5.0, backward), (0.0, none), (f32::NAN, none)] {
                assert_eq!(bridge.channels(torque_nm), want, "{mode:?}, {torque_nm} N m");
            }
            let reversed = Modulation { direction: Direction::Reverse, ..bridge };
            assert_eq!(
                [5.0, -5.0].map(|torque_nm| reversed.channels(torque_nm)),
                [backward, forward],
                "{mode:?}"
            );
        }
        let halves = Modulation { mode: StageMode::Complementary, ..AMPLIFIER };
        assert_eq!([5.0, -5.0, 0.0].map(|it| halves.channels(it)), [[0.75, 0.25], [0.25, 0.75], [0.5, 0.5]]);
    }

    #[test]
    fn the_size_of_a_torque_has_the_whole_duty_and_needs_no_offset() {
        near(BRIDGE.largest_torque_nm(), 19.0);
        assert_eq!(BRIDGE.check(19.0), Ok(()));
        assert_eq!(BRIDGE.channels(100.0), [0.95, 1.0]);
        let name = |modulation: Modulation| modulation.check(1.0).map_err(|error| error.name);
        assert_eq!(name(Modulation { offset: 0.1, ..BRIDGE }), Err("duty_offset"));
        let halves = Modulation { mode: StageMode::Complementary, ..AMPLIFIER };
        assert_eq!(name(halves), Ok(()));
        assert_eq!(
            name(Modulation { offset: 0.4, ..halves }),
            Err("duty_offset"),
            "voltage without a torque"
        );
        assert_eq!(name(Modulation { offset: 0.4, ..AMPLIFIER }), Ok(()));
        assert_eq!(BRIDGE.check(19.1).map_err(|error| error.name), Err("torque_limit_nm"));
    }

    #[test]
    fn a_board_has_its_first_mode_unless_another_of_its_own_is_chosen() {
        let board = [StageMode::Complementary, StageMode::PwmDirection];
        assert_eq!(StageChoice::Board.on(&board), Ok(StageMode::Complementary));
        assert_eq!(StageChoice::PwmDirection.on(&board), Ok(StageMode::PwmDirection));
        assert_eq!(StageChoice::Amplifier.on(&board).map_err(|error| error.name), Err("stage_mode"));
    }

    /// Records the calls.
    #[derive(Default)]
    struct Recorder(Vec<&'static str>);

    impl PowerStage for Recorder {
        fn enable(&mut self, _: &Modulation) {
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
        let on = StageCommand::Torque { torque_nm: 1.0, modulation: AMPLIFIER };
        for command in [on, on, StageCommand::Off, on] {
            actuator.follow(command);
        }
        assert_eq!(actuator.stage().0, ["disable", "enable", "apply", "apply", "disable", "enable", "apply"]);
    }
}
