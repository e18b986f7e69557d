//! The board that the features select.

#[cfg(not(feature = "board-odrive-v3"))]
pub(super) use super::f405_bare::{CRYSTAL_HZ, Lines, LoadEncoder, MotorEncoder, NAME, start};
#[cfg(feature = "board-odrive-v3")]
pub(super) use super::odrive_v3::{CRYSTAL_HZ, Lines, LoadEncoder, MotorEncoder, NAME, start};
