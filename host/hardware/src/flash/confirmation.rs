//! What the drive has to report after writing: build and board of the image.

use std::thread;
use std::time::{Duration, Instant};

use lashloop_bench::device::{Build, Device, DeviceChoice, DeviceError};
use lashloop_bench::supervisor::Supervisor;

use super::error::FlashError;
use super::image::Image;
use lashloop::rig::way::Way;

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

    /// Whether a drive that reports this runs the image. All builds with changes of a commit have one id: such a drive that
    /// reported it before may never have been reached.
    fn judge(&self, drive: Build, board: &str, before: Option<Build>) -> Result<(), FlashError> {
        if drive != self.build {
            return Err(FlashError::OtherBuild { drive, image: self.build });
        }
        if board != self.board {
            return Err(FlashError::OtherBoard { drive: board.to_owned(), image: self.board.clone() });
        }
        if drive.is_dirty && before == Some(drive) {
            return Err(FlashError::SameBuild { drive });
        }
        Ok(())
    }
}

/// Waits for the drive and compares what it reports. `before` is the build that it reported before, unless it has entered its
/// boot loader since.
///
/// # Errors
/// No drive completes the handshake in time, or it reports another build or board, or one that it reported before.
pub fn confirm(
    way: Way,
    expected: &Expected,
    before: Option<Build>,
    choice: &DeviceChoice,
    baud: u32,
    supervisor: &Supervisor,
) -> Result<Device, FlashError> {
    let device = wait(choice, baud, supervisor).map_err(|source| FlashError::Silent { way, source })?;
    let identity = &device.session.identity;
    expected.judge(Build::of(identity), identity.board.as_str(), before)?;
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

#[cfg(test)]
mod tests {
    use std::num::NonZeroU32;

    use super::*;

    #[test]
    fn a_build_with_changes_that_the_drive_reported_before_confirms_nothing() {
        let build = |id, is_dirty| Build { commit: NonZeroU32::new(id), is_dirty };
        let judge = |image, before| {
            Expected { build: image, board: "stm32f405".to_owned() }.judge(image, "stm32f405", before)
        };
        let changed = build(7, true);
        assert!(matches!(judge(changed, Some(changed)), Err(FlashError::SameBuild { .. })));
        for before in [None, Some(build(7, false)), Some(build(8, true))] {
            assert!(judge(changed, before).is_ok(), "{before:?}");
        }
        // One commit without changes is one image.
        assert!(judge(build(7, false), Some(build(7, false))).is_ok());
    }
}
