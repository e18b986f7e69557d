//! The program under test.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::workspace;

/// Path of `lashloop`, built with the profile of this test into its target directory.
///
/// Cargo passes the path of a program only to the tests of its own package, so we call cargo to build it. We build with
/// `--workspace`, because the features then match those of `cargo test --workspace` and the program is built already.
///
/// # Panics
/// The build fails; the panic shows cargo's output.
pub fn lashloop() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| build().join("lashloop"))
}

/// Path of the program of an example, such as `own-law`, built as [`lashloop`](lashloop()) is.
///
/// # Panics
/// The build fails; the panic shows cargo's output.
#[must_use]
pub fn example(name: &str) -> PathBuf {
    lashloop().with_file_name(name)
}

/// Builds the programs and returns their folder.
fn build() -> PathBuf {
    let test = env::current_exe().expect("the path of this test");
    // <target>/<profile>/deps/<test>
    let folder = test.ancestors().nth(2).expect("a test lies in the deps folder of its profile");
    // `cargo xtask test` runs each test in a process of its own, and has built the programs for all.
    if env::var_os("LASHLOOP_PROGRAMS_ARE_BUILT").is_some() {
        return folder.to_owned();
    }
    let target = folder.parent().expect("a profile's folder lies in the target folder");
    let profile = match folder.file_name().and_then(|name| name.to_str()) {
        Some("debug") => "dev",
        Some(name) => name,
        None => panic!("{} is not the folder of a profile", folder.display()),
    };
    let built = Command::new(env!("CARGO"))
        .args(["programs", "--quiet", "--profile", profile, "--target-dir"])
        .arg(target)
        .current_dir(workspace())
        .output()
        .expect("cargo starts");
    assert!(built.status.success(), "the programs do not build: {}", String::from_utf8_lossy(&built.stderr));
    folder.to_owned()
}
