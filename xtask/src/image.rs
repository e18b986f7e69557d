//! Building the Arm image.

use std::fs;

use anyhow::{Context, Result};

use crate::arm_toolchain::{ArmToolchain, TARGET};
use crate::command;

/// Builds the image and puts it where everybody looks for it.
pub(crate) fn build() -> Result<()> {
    command::run(&mut ArmToolchain::find()?.build())?;
    let built = crate::root().join("target").join(TARGET).join("image/lashloop-firmware");
    let image = crate::image_path();
    // Renamed into place, so that an emulator starting at this moment reads either the old or the new image.
    let copy = image.with_extension("elf.new");
    fs::copy(&built, &copy).with_context(|| format!("{} cannot be copied", built.display()))?;
    fs::rename(&copy, &image).with_context(|| format!("{} cannot be replaced", image.display()))
}
