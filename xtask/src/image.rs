//! Building the Arm images.

use std::fs;

use anyhow::{Context, Result};

use crate::arm_toolchain::{ArmToolchain, Program, TARGET, drives, programs};
use crate::{command, paths};

/// Builds the images and copies them to their well-known places.
pub(crate) fn build() -> Result<()> {
    let toolchain = ArmToolchain::find()?;
    for program in programs()? {
        command::run(&mut toolchain.build(&program))?;
        publish(program.name, &program.image)?;
    }
    Ok(())
}

/// Builds the image of one board.
///
/// # Errors
/// The board is unknown, or its image can't be built.
pub(crate) fn build_for(board: &str) -> Result<()> {
    let drives = drives()?;
    let found = drives.iter().find(|program| program.board() == Some(board));
    let program = found.with_context(|| {
        let boards: Vec<_> = drives.iter().filter_map(Program::board).collect();
        format!("no board {board}: firmware/Cargo.toml has features for {}", boards.join(", "))
    })?;
    command::run(&mut ArmToolchain::find()?.build(program))?;
    publish(program.name, &program.image)
}

/// Copies a program that was built to the well-known place of its image.
///
/// # Errors
/// It can't be copied.
pub(crate) fn publish(program: &str, image: &str) -> Result<()> {
    let built = paths::root().join("target").join(TARGET).join("image").join(program);
    let image = paths::image(image);
    // Renaming is atomic: an emulator that starts now reads either the old or the new image.
    let copy = image.with_extension("elf.new");
    fs::copy(&built, &copy).with_context(|| format!("{} can't be copied", built.display()))?;
    fs::rename(&copy, &image).with_context(|| format!("{} can't be replaced", image.display()))?;
    // Cargo's list of the sources: the bench warns of an image that is older than one of them.
    let list = image.with_extension("d");
    fs::copy(built.with_extension("d"), &list)
        .with_context(|| format!("{} can't be written", list.display()))?;
    Ok(())
}
