//! Building the Arm images.

use std::fs;

use anyhow::{Context, Result};

use crate::arm_toolchain::{ArmToolchain, CODEC_COST, DRIVE, TARGET};
use crate::{command, paths};

/// Builds the images and puts them where everybody looks for them.
pub(crate) fn build() -> Result<()> {
    let toolchain = ArmToolchain::find()?;
    for program in [DRIVE, CODEC_COST] {
        command::run(&mut toolchain.build(program))?;
        let built = paths::root().join("target").join(TARGET).join("image").join(program);
        let image = paths::image(program);
        // Renamed into place, so that an emulator starting at this moment reads either the old or the new image.
        let copy = image.with_extension("elf.new");
        fs::copy(&built, &copy).with_context(|| format!("{} cannot be copied", built.display()))?;
        fs::rename(&copy, &image).with_context(|| format!("{} cannot be replaced", image.display()))?;
    }
    Ok(())
}
