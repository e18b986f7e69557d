//! Virtual silicon: a workspace of its own, because its processor model takes minutes to build.
//!
//! The build stays in `target/virtual-silicon`, so a machine builds it once.

use std::process::Command;

use anyhow::{Context, Result};

use crate::arm_toolchain::ArmToolchain;
use crate::command::{cargo, run};
use crate::test_programs::{self, TestProgram};
use crate::{image, paths};

/// The image of virtual silicon's own tests, and where it is built from.
const PROBE: (&str, &str) = ("silicon-probe", "virtual-silicon/probe/Cargo.toml");

/// Builds the program `lashloop-silicon`.
///
/// # Errors
/// It doesn't build.
pub(crate) fn build() -> Result<()> {
    run(&mut in_workspace("build --bins")).context("virtual silicon doesn't build")
}

/// Builds the image of its own tests.
///
/// # Errors
/// It doesn't build.
pub(crate) fn build_probe() -> Result<()> {
    let (program, manifest) = PROBE;
    run(&mut ArmToolchain::find()?.build_manifest(manifest))?;
    image::publish(program, program)
}

/// Builds its own tests.
///
/// # Errors
/// They don't build.
pub(crate) fn test_programs() -> Result<Vec<TestProgram>> {
    test_programs::build_with(in_workspace("test"))
}

/// A cargo command there. The models' manifest asks for a later compiler than the pinned one, which builds them all the same.
fn in_workspace(command: &str) -> Command {
    let mut command = cargo(command);
    command.args(["--release", "--locked", "--ignore-rust-version"]);
    command.args(["--manifest-path", "virtual-silicon/Cargo.toml", "--target-dir"]);
    command.arg(paths::root().join("target/virtual-silicon"));
    command
}
