//! What builds for the board: the first of these that is there.
//!
//! 1. The `core` library of the target, as rustup installs it. Nothing else is needed.
//! 2. Debian's compiler with the sources of `core`, which is then built along. Linking takes the linker that comes
//!    with rustup's toolchain, for Debian's compiler has none for Arm. Compiler and sources have to be of one
//!    version, so rustup's compiler can't use Debian's sources.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use crate::{command, paths};

pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";

/// The drive.
pub(crate) const DRIVE: &str = "lashloop-firmware";
/// What counts the codec's instructions; behind a feature of the same name, because it is for Arm alone.
pub(crate) const CODEC_COST: &str = "codec-cost";

const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_CARGO_CLIPPY: &str = "/usr/bin/cargo-clippy";

pub(crate) enum ArmToolchain {
    WithCore,
    CoreFromSource { linker: PathBuf },
}

impl ArmToolchain {
    /// Looks what is installed.
    ///
    /// # Errors
    /// A sentence that says what to install.
    pub(crate) fn find() -> Result<Self> {
        if core_is_installed() {
            return Ok(Self::WithCore);
        }
        if debian_core_source_is_installed()
            && let Some(linker) = rust_lld()
        {
            return Ok(Self::CoreFromSource { linker });
        }
        bail!(
            "no core library for the Arm image: `rustup target add {TARGET}` installs it, or on Debian \
             `apt-get install --no-install-recommends rustc-web rust-web-src` its sources"
        )
    }

    /// `cargo build` of a program of the firmware for the board.
    pub(crate) fn build(&self, program: &str) -> Command {
        let mut command = command::cargo();
        command.arg("build");
        self.describe(program, &mut command);
        command
    }

    /// `cargo clippy` of the same; `None` where this compiler has no clippy.
    pub(crate) fn clippy(&self) -> Option<Command> {
        let mut command = match self {
            Self::WithCore => command::cargo(),
            Self::CoreFromSource { .. } if !Path::new(DEBIAN_CARGO_CLIPPY).exists() => return None,
            // Called by its path: `cargo clippy` would find the one of rustup's compiler.
            Self::CoreFromSource { .. } => {
                let mut command = Command::new(DEBIAN_CARGO_CLIPPY);
                command.current_dir(paths::root());
                command
            }
        };
        command.arg("clippy");
        self.describe(DRIVE, &mut command);
        command.args(["--", "-D", "warnings"]);
        Some(command)
    }

    fn describe(&self, program: &str, command: &mut Command) {
        command.args(["--package", "lashloop-firmware", "--bin", program]);
        command.args(["--features", if program == CODEC_COST { CODEC_COST } else { "image" }]);
        // The folder is ours to name: the image has one well-known place, whatever CARGO_TARGET_DIR says.
        command.args(["--target", TARGET, "--profile", "image", "--target-dir"]);
        command.arg(paths::root().join("target"));
        if let Self::CoreFromSource { linker } = self {
            command.env("RUSTC", DEBIAN_RUSTC);
            command.env("RUSTC_BOOTSTRAP", "1");
            command.env("CARGO_UNSTABLE_BUILD_STD", "core");
            command.env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", linker);
        }
    }
}

fn core_is_installed() -> bool {
    // The path is printed whether it exists or not.
    let libraries =
        command::first_line(Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]));
    libraries.is_some_and(|folder| {
        files_in(Path::new(&folder)).any(|name| name.starts_with("libcore-") && name.ends_with(".rlib"))
    })
}

fn debian_core_source_is_installed() -> bool {
    sysroot(DEBIAN_RUSTC).is_some_and(|sysroot| sysroot.join("lib/rustlib/src/rust/library/core").is_dir())
}

/// The linker of the compiler in `PATH`.
fn rust_lld() -> Option<PathBuf> {
    let host_parts = sysroot("rustc")?.join("lib/rustlib");
    files_in(&host_parts).map(|host| host_parts.join(host).join("bin/rust-lld")).find(|path| path.is_file())
}

fn sysroot(rustc: &str) -> Option<PathBuf> {
    command::first_line(Command::new(rustc).args(["--print", "sysroot"])).map(PathBuf::from)
}

fn files_in(folder: &Path) -> impl Iterator<Item = String> + use<> {
    fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
}
