//! Why a drive isn't flashed, and how to go on.

use std::path::PathBuf;

use lashloop_bench::device::{Build, DeviceError};

use super::image::{FLASH, ImageError};
use super::program::ProgramError;
use super::way::Way;

/// Why a drive isn't flashed.
#[derive(Debug, thiserror::Error)]
pub enum FlashError {
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The image is missing.
    #[error(transparent)]
    NoImage(DeviceError),
    /// No way leads to the chip, or the chosen one doesn't. Nothing was written.
    #[error("no way onto the chip:\n{}", listed(.0))]
    NoWay(Vec<(Way, String)>),
    /// A drive has entered its boot loader by request, and no way leads there. Nothing was written.
    #[error(
        "the drive is in its boot loader, and no way leads there; reset the board to start its firmware again:\n{}",
        listed(.0)
    )]
    Unreached(Vec<(Way, String)>),
    /// A program failed after it had been started to write.
    #[error("not flashed: {source}; {}", way.recovery())]
    Writing { way: Way, source: ProgramError },
    /// The flash doesn't hold what was written.
    #[error(
        "not flashed: the byte at {:#010x} reads back as {have:#04x}, {want:#04x} was written; {}",
        FLASH.start as usize + offset,
        way.recovery()
    )]
    Different { way: Way, offset: usize, have: u8, want: u8 },
    /// The bytes can't be passed to the program, or not be read from it.
    #[error("{}: {source}; is the disk full?", path.display())]
    File { path: PathBuf, source: std::io::Error },
    /// It was written, and the drive doesn't complete a handshake.
    #[error(
        "written and compared, but not confirmed: no drive reports the build: {source}; if BOOT0 is still high, pull it low and \
         reset the board, then `lashloop doctor`; {}",
        way.recovery()
    )]
    Silent { way: Way, source: DeviceError },
    /// Another build runs than that of the image.
    #[error(
        "written and compared, but the drive reports {drive}, and the image is {image}: another board answers on this port, or \
         the reset failed; check --device, then power the board off and on"
    )]
    OtherBuild { drive: Build, image: Build },
    /// The ELF has no build to compare with.
    #[error(
        "written and compared, but not confirmed: the drive reports {drive}, and {} has no build to compare with: build the image \
         in a git repository, with the linker script of lashloop-firmware",
        image.display()
    )]
    NoBuild { drive: Build, image: PathBuf },
    /// Which port the drive is at, is not clear.
    #[error(
        "{0} serial ports on USB: name that of the drive by --device, or the rig by --rig; `lashloop ports` lists them"
    )]
    Ports(usize),
}

impl FlashError {
    /// Whether the user has interrupted.
    #[must_use]
    pub fn is_interruption(&self) -> bool {
        matches!(self, Self::Writing { source: ProgramError::Interrupted { .. }, .. })
    }
}

fn listed(reasons: &[(Way, String)]) -> String {
    reasons.iter().map(|(way, reason)| format!("  {:<6} {reason}", way.name())).collect::<Vec<_>>().join("\n")
}
