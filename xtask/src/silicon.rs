//! Virtual silicon: a workspace of its own, because its processor model takes minutes to build.
//!
//! The build stays in `target/virtual-silicon`, so one machine pays for it once.

use anyhow::{Context, Result};

use crate::arm_toolchain::ArmToolchain;
use crate::command::{cargo, run};
use crate::counts::Counts;
use crate::paths;

/// Common to all calls. The model's manifest asks for a later compiler than the pinned one, which builds it all the same.
const OPTIONS: &str = "--release --locked --ignore-rust-version --manifest-path virtual-silicon/Cargo.toml";

/// Builds the program `lashloop-silicon`.
///
/// # Errors
/// It doesn't build.
pub(crate) fn build() -> Result<()> {
    run(cargo("build").args(OPTIONS.split(' ')).arg("--target-dir").arg(paths::root().join(FOLDER)))
        .context("virtual silicon doesn't build")
}
