//! Passes the commit to the build, and memory map and linker script to the Arm image.
//!
//! The linker arguments are not in `.cargo/config.toml` because `RUSTFLAGS` would silently replace them there.

use std::env;
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=LASHLOOP_BUILD_ID={}", build_id());
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo::rerun-if-changed=memory.x");
        println!(
            "cargo::rustc-link-search={}",
            env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR")
        );
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
    }
}

/// First 32 bits of the commit in hexadecimal; zeros without a repository or without git.
fn build_id() -> String {
    // Every commit, checkout and reset writes to the log of HEAD; HEAD itself covers repositories without logs.
    // Cargo treats a missing file as changed and would rebuild on every call, so we list existing files only.
    for name in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--git-path", name]).filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    let commit = git(&["rev-parse", "HEAD"]).unwrap_or_default();
    commit.get(..8).unwrap_or("00000000").to_owned()
}

fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
