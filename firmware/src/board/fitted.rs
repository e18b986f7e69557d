//! The board that the features select.

#[cfg(not(any(
    feature = "board-odrive-v3",
    feature = "board-nucleo-f429zi",
    feature = "board-nucleo-f446re"
)))]
pub(super) use super::f405_bare::*;
#[cfg(feature = "board-nucleo-f429zi")]
pub(super) use super::nucleo_f429zi::*;
#[cfg(feature = "board-nucleo-f446re")]
pub(super) use super::nucleo_f446re::*;
#[cfg(feature = "board-odrive-v3")]
pub(super) use super::odrive_v3::*;
