//! The drive's own report after writing.

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

/// Waits for the drive and compares the build that it reports with that of the image.
///
/// # Errors
/// No drive completes the handshake in time, it reports another build, or the image has none to compare with.
pub fn confirm(
    way: Way,
    image: &Image,
    choice: &DeviceChoice,
    baud: u32,
    supervisor: &Supervisor,
) -> Result<Device, FlashError> {
    let device = wait(choice, baud, supervisor).map_err(|source| FlashError::Silent { way, source })?;
    let drive = Build::of(&device.session.identity);
    match image.build {
        Some(build) if build == drive => Ok(device),
        Some(image) => Err(FlashError::OtherBuild { drive, image }),
        None => Err(FlashError::NoBuild { drive, image: image.path.clone() }),
    }
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
