//! Passes the commit to the build, and whether the sources differ from it; memory map and linker script to the Arm image.
//!
//! The linker arguments are not in `.cargo/config.toml` because `RUSTFLAGS` would silently replace them there.

use std::path::Path;
use std::process::Command;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let (build_id, is_dirty) = (build_id(), u8::from(is_dirty()));
    println!("cargo::rustc-env=LASHLOOP_BUILD_ID={build_id}");
    println!("cargo::rustc-env=LASHLOOP_BUILD_DIRTY={is_dirty}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo::rerun-if-changed=memory.x");
        let folder = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
        // Absolute symbols take no flash. `lashloop flash` compares them with what the drive reports.
        let symbols = format!("_lashloop_build_id = 0x{build_id};\n_lashloop_build_is_dirty = {is_dirty};\n");
        // Virtual silicon wires the pins of the board that the image is for.
        let boards = [
            ("NUCLEO_F429ZI", "nucleo-f429zi"),
            ("NUCLEO_F446RE", "nucleo-f446re"),
            ("ODRIVE_V3", "odrive-v3"),
        ];
        let selected = |feature: &str| env::var_os(format!("CARGO_FEATURE_BOARD_{feature}")).is_some();
        let name = boards.iter().find(|(feature, _)| selected(feature)).map_or("stm32f405", |it| it.1);
        let board = format!("\"_lashloop_board_{name}\" = 1;\n");
        let memory = fs::read_to_string("memory.x").expect("the memory map") + &symbols + &board;
        fs::write(Path::new(&folder).join("memory.x"), memory).expect("cargo makes OUT_DIR writable");
        println!("cargo::rustc-link-search={folder}");
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        // `lashloop flash` refuses it.
        println!("cargo::rustc-link-arg-bin=codec-cost=--defsym=_lashloop_no_drive=1");
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

/// What the firmware is compiled from, besides registry crates: relative to this package, in Lashloop's repository.
const SOURCES: [&str; 5] =
    ["src", "Cargo.toml", "../protocol/src", "../protocol/Cargo.toml", "../Cargo.toml"];

/// Whether the sources differ from the commit, or whether that is unknown.
///
/// The check covers exactly the files that Cargo watches here, so it is repeated whenever its result may change, and costs
/// one `git status` of two folders. It doesn't cover the toolchain, the lock file, new files that git doesn't track, and
/// the crate of a user's own laws: their changes leave the mark at 0.
fn is_dirty() -> bool {
    for source in SOURCES.iter().filter(|source| Path::new(source).exists()) {
        println!("cargo::rerun-if-changed={source}");
    }
    let status = ["status", "--porcelain", "--untracked-files=no", "--"];
    git(&[&status[..], &SOURCES[..]].concat()).is_none_or(|changes| !changes.is_empty())
}

fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
