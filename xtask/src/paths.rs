//! Well-known places in the workspace.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// The workspace.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package is a folder of the workspace")
}

/// The Arm image of a program, where the bench and the tests look for it.
pub(crate) fn image(program: &str) -> PathBuf {
    root().join("target").join(program).with_extension("elf")
}

/// Makes the folder, and removes what was in it.
///
/// # Errors
/// A file can't be removed, or the folder can't be created.
pub(crate) fn empty_folder(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("{} can't be emptied", folder.display()))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("{} can't be created", folder.display()))
}
