//! What the drive has to report after writing: build and board of the image.

use std::thread;
use std::time::{Duration, Instant};

use lashloop_bench::device::{Build, Device, DeviceChoice, DeviceError};
use lashloop_bench::supervisor::Supervisor;

use super::error::FlashError;
use super::image::Image;
use super::way::Way;

/// Time for restart, enumeration and handshake.
const LIMIT: Duration = Duration::from_secs(15);
/// Time between two attempts.
const INTERVAL: Duration = Duration::from_millis(200);

/// What the drive has to report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Expected {
    pub build: Build,
    pub board: String,
}

impl Expected {
    /// # Errors
    /// The image lacks one of them, so no drive could confirm it.
    pub fn of(image: &Image) -> Result<Self, FlashError> {
        let Image { path, build, board, .. } = image;
        Ok(Self {
            build: build.ok_or_else(|| FlashError::NoBuild(path.clone()))?,
            board: board.clone().ok_or_else(|| FlashError::NoBoard(path.clone()))?,
        })
    }
}

/// Waits for the drive and compares what it reports.
///
/// # Errors
/// No drive completes the handshake in time, or it reports another build or board.
pub fn confirm(
    way: Way,
    expected: &Expected,
    choice: &DeviceChoice,
    baud: u32,
    supervisor: &Supervisor,
) -> Result<Device, FlashError> {
    let device = wait(choice, baud, supervisor).map_err(|source| FlashError::Silent { way, source })?;
    let identity = &device.session.identity;
    let (drive, Expected { build, board }) = (Build::of(identity), expected);
    if drive != *build {
        return Err(FlashError::OtherBuild { drive, image: *build });
    }
    if identity.board.as_str() != board {
        return Err(FlashError::OtherBoard {
            drive: identity.board.as_str().to_owned(),
            image: board.clone(),
        });
    }
    Ok(device)
}

/// Opens the drive once its port is there and it answers.
fn wait(choice: &DeviceChoice, baud: u32, supervisor: &Supervisor) -> Result<Device, DeviceError> {
    let deadline = Instant::now() + LIMIT;
    loop {
        match Device::open(choice, baud, supervisor) {
            Err(error) if Instant::now() >= deadline || supervisor.interrupted() => return Err(error),
            Err(_) => thread::sleep(INTERVAL),
            opened => return opened,
        }
    }
}
