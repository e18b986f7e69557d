//! The choice of a method, and the writing.

use super::error::FlashError;
use super::image::Image;
use super::program::Runner;
use super::target::Target;
use super::{dfu, probe, uart};
use lashloop::rig::way::Way;

/// Finds the first available method: of all, or of one. Nothing is written.
///
/// # Errors
/// None is available; the error has the reason of each.
pub fn find(only: Option<Way>, target: &Target, runner: &Runner<'_>) -> Result<Way, FlashError> {
    let mut reasons = Vec::new();
    for way in Way::ALL.into_iter().filter(|way| only.is_none_or(|only| only == *way)) {
        let look = match way {
            Way::Probe => probe::look(target, runner),
            Way::Dfu => dfu::look(runner),
            Way::Uart => uart::look(target, runner),
        };
        match look {
            Ok(()) => return Ok(way),
            Err(reason) => reasons.push((way, reason)),
        }
    }
    Err(FlashError::NoWay(reasons))
}

/// Writes an image, compares it with the flash, and starts it.
///
/// # Errors
/// The program of the method fails or is interrupted, or the flash differs; the error has how to continue.
pub fn write(way: Way, image: &Image, target: &Target, runner: &Runner<'_>) -> Result<(), FlashError> {
    let folder =
        tempfile::tempdir().map_err(|source| FlashError::File { path: std::env::temp_dir(), source })?;
    match way {
        Way::Probe => {
            probe::write(image, target, runner).map_err(|source| FlashError::Writing { way, source })
        }
        Way::Dfu => dfu::write(image, folder.path(), runner),
        Way::Uart => uart::write(image, target, folder.path(), runner),
    }
}
