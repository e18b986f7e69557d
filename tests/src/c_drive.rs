//! The drive in C, built once from `examples/drive-in-c`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::{program, workspace};

/// Path of the drive; it serves its standard input and output.
///
/// # Panics
/// The drive does not build; the panic shows the compiler's output.
pub fn path() -> &'static Path {
    static DRIVE: OnceLock<PathBuf> = OnceLock::new();
    DRIVE.get_or_init(build)
}

/// The drive as `--device` takes it.
#[must_use]
pub fn device() -> String {
    format!("exec:{}", path().display())
}

fn build() -> PathBuf {
    // Next to the program under test, under a name of this process: other test programs build it at the same time.
    let folder = program::lashloop().parent().expect("the folder of the profile");
    let [drive, unfinished] =
        ["drive-in-c".to_owned(), format!("drive-in-c-{}", std::process::id())].map(|name| folder.join(name));
    let built = Command::new("make")
        .args(["-B", "-C", "examples/drive-in-c"])
        .arg(format!("DRIVE={}", unfinished.display()))
        .current_dir(workspace())
        .output()
        .expect("make starts");
    assert!(built.status.success(), "the drive does not build: {}", String::from_utf8_lossy(&built.stderr));
    std::fs::rename(&unfinished, &drive).expect("the drive can be renamed");
    drive
}
