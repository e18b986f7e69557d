//! The board that the features select.

#[cfg(not(any(feature = "board-odrive-v3", feature = "board-nucleo-f446re")))]
pub(super) use super::f405_bare::{HAS_CLOCK, Lines, LoadEncoder, MotorEncoder, NAME, start};
#[cfg(feature = "board-nucleo-f446re")]
pub(super) use super::nucleo_f446re::{HAS_CLOCK, Lines, LoadEncoder, MotorEncoder, NAME, start};
#[cfg(feature = "board-odrive-v3")]
pub(super) use super::odrive_v3::{HAS_CLOCK, Lines, LoadEncoder, MotorEncoder, NAME, start};
