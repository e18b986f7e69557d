//! Well-known places in the workspace.

use std::path::{Path, PathBuf};

/// The workspace.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package is a folder of the workspace")
}

/// The Arm image of a program, where the bench and the tests look for it.
pub(crate) fn image(program: &str) -> PathBuf {
    root().join("target").join(program).with_extension("elf")
}
