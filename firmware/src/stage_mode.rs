//! What the outputs of a board mean to its power stage.

use crate::law::ParameterError;

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
    pub(crate) fn is_of_size(self) -> bool {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_has_its_first_mode_unless_another_of_its_own_is_chosen() {
        let board = [StageMode::Complementary, StageMode::PwmDirection];
        assert_eq!(StageChoice::Board.on(&board), Ok(StageMode::Complementary));
        assert_eq!(StageChoice::PwmDirection.on(&board), Ok(StageMode::PwmDirection));
        assert_eq!(StageChoice::Amplifier.on(&board).map_err(|error| error.name), Err("stage_mode"));
    }
}
