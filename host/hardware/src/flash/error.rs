//! Why a drive isn't flashed, and how to continue.

use std::path::PathBuf;

use lashloop_bench::device::{Build, DeviceError};
use lashloop_session::printable;

use super::image::{FLASH, ImageError};
use super::program::ProgramError;
use lashloop::rig::way::Way;

/// Why a drive isn't flashed.
#[derive(Debug, thiserror::Error)]
pub enum FlashError {
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The image is missing.
    #[error(
        "no image of the firmware at {}: build it with `cargo xtask image`, or name the ELF as argument or by LASHLOOP_IMAGE",
        .0.iter().map(|place| place.display().to_string()).collect::<Vec<_>>().join(", ")
    )]
    NoImage(Vec<PathBuf>),
    /// The ELF has no build to compare with. Nothing was written.
    #[error(
        "nothing is written: {} has no build to compare with, so no drive could confirm it: build the image in a git repository, \
         with the linker script of lashloop-firmware",
        .0.display()
    )]
    NoBuild(PathBuf),
    /// The ELF has no board. Nothing was written.
    #[error(
        "nothing is written: {} does not name its board, and the image of another board drives wrong pins: build it anew with \
         `cargo xtask image`, or with the linker script of lashloop-firmware",
        .0.display()
    )]
    NoBoard(PathBuf),
    /// The image is for another board. Nothing was written.
    #[error(
        "nothing is written: {} is for the board {}, and that of {of} is {}: the pins differ; name the image of that board{}",
        path.display(),
        printable(image),
        printable(board),
        if *is_drive { ", or describe the board by a rig file if the drive has the wrong image" } else { "" }
    )]
    Board {
        /// The image.
        path: PathBuf,
        /// Its board.
        image: String,
        /// What has the other one: the rig file or the drive.
        of: String,
        board: String,
        is_drive: bool,
    },
    /// Neither the user nor a drive has named the board. Nothing was written.
    #[error(
        "nothing is written: no drive answers that names its board, and the image is for the board {}: the pins of another one \
         differ; if it is that board, call again with --board {}, or describe it by a rig file",
        printable(.0),
        printable(.0)
    )]
    Unnamed(String),
    /// The device isn't a board. Nothing was written.
    #[error(
        "nothing is written: {0} is a simulator, which no loader reaches; name a terminal, tcp:HOST:PORT or rfc2217:HOST:PORT"
    )]
    Simulator(String),
    /// No way leads to the chip, or the chosen one doesn't. Nothing was written.
    #[error("no way onto the chip:\n{}", listed(.0))]
    NoWay(Vec<(Way, String)>),
    /// A drive has entered its boot loader by request, and no way leads there. Nothing was written.
    #[error(
        "the drive is in its boot loader, and no way leads there; reset the board to start its firmware again:\n{}",
        listed(.0)
    )]
    Unreached(Vec<(Way, String)>),
    /// A chip is in its boot loader while the drive answers. Nothing was written.
    #[error(
        "nothing is written: the drive on {device} answers, so the chip that {} finds in its boot loader is another one: reset or \
         disconnect that board and call again, or name the port of that chip by --device",
        way.program()
    )]
    AnotherChip { way: Way, device: String },
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
    /// It was written, and which port the drive is at is not clear, so it was not asked.
    #[error(
        "written and compared, but not confirmed: {ports} serial ports on USB, and none of them is new: `lashloop doctor` with the \
         drive's port shows the build that it reports; name that port by --device the next time"
    )]
    Unasked { ports: usize },
    /// Another build runs than that of the image.
    #[error(
        "written and compared, but the drive reports {drive}, and the image is {image}: another board answers on this port, or \
         the reset failed; check --device, then power the board off and on"
    )]
    OtherBuild { drive: Build, image: Build },
    /// A drive on another board than that of the image reports its build.
    #[error(
        "written and compared, but the drive reports the board {}, and the image is for {}: another drive answers on this port; \
         check --device",
        printable(drive),
        printable(image)
    )]
    OtherBoard { drive: String, image: String },
    /// The drive reports what it reported before, and that names no single image.
    #[error(
        "written and compared, but not confirmed: the drive reported {drive} before too, and all builds with changes of a commit \
         have its id: commit, build and flash again, or flash by dfu or uart, for which the drive itself enters its boot loader"
    )]
    SameBuild { drive: Build },
    /// Which port the drive is at, is not clear.
    #[error(
        "{0} serial ports on USB: name that of the drive by --device, or the rig by --rig; `lashloop doctor` lists them"
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
