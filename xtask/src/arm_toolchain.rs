//! The toolchain for the board: the first of these that is installed.
//!
//! 1. The `core` library of the target, as rustup installs it. Nothing else is needed.
//! 2. Debian's compiler with the sources of `core`, which it then builds. The linker is that of rustup's toolchain:
//!    Debian's compiler has none for Arm. Compiler and sources must have one version, so rustup's compiler can't use
//!    Debian's sources.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::command::{cargo, command, first_line};
use crate::paths;

pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";

/// A program for the board. Its feature builds for Arm alone.
pub(crate) struct Program {
    package: &'static str,
    /// Name of the program.
    pub(crate) name: &'static str,
    /// Name of its image without the suffix.
    pub(crate) image: String,
    features: String,
}

impl Program {
    /// The board of a drive.
    pub(crate) fn board(&self) -> Option<&str> {
        self.features.strip_prefix("image,board-")
    }
}

/// The board that has the image without a suffix to its name.
const FIRST_BOARD: &str = "f405-bare";

/// The drive on each board that `firmware/Cargo.toml` has a feature for. The first board is the last one: all builds have one place,
/// and the last one stays there.
///
/// # Errors
/// The file can't be read.
pub(crate) fn drives() -> Result<Vec<Program>> {
    let path = paths::root().join("firmware/Cargo.toml");
    let manifest = fs::read_to_string(&path).with_context(|| format!("{} can't be read", path.display()))?;
    let boards = manifest.lines().filter_map(|line| line.strip_prefix("board-")?.split_once(" = "));
    let others = boards.map(|(board, _)| board).filter(|board| *board != FIRST_BOARD);
    let drive = |board: &str, image| Program {
        package: "lashloop-firmware",
        name: "lashloop-firmware",
        image,
        features: format!("image,board-{board}"),
    };
    let others = others.map(|board| drive(board, format!("lashloop-firmware-{board}")));
    Ok(others.chain([drive(FIRST_BOARD, "lashloop-firmware".to_owned())]).collect())
}

/// Every program for a board.
///
/// # Errors
/// As [`drives`].
pub(crate) fn programs() -> Result<Vec<Program>> {
    let other = |package, name: &'static str, features: &str| Program {
        package,
        name,
        image: name.to_owned(),
        features: features.to_owned(),
    };
    let with_laws = "image,lashloop-firmware/board-f405-bare";
    let others = [
        // Counts the codec's instructions.
        other("lashloop-firmware", "codec-cost", "codec-cost,board-f405-bare"),
        // A drive with a law from a crate of its own.
        other("own-law", "own-law-image", with_laws),
        // A drive with published laws, whose instructions are counted.
        other("published-laws", "published-laws-image", with_laws),
    ];
    Ok(drives()?.into_iter().chain(others).collect())
}

const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_CLIPPY: &str = "/usr/bin/clippy-driver";

pub(crate) enum ArmToolchain {
    WithCore,
    CoreFromSource { linker: PathBuf },
}

impl ArmToolchain {
    /// # Errors
    /// Nothing is installed; the sentence names what to install.
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

    /// `cargo build` of a program for the board.
    pub(crate) fn build(&self, program: &Program) -> Command {
        self.for_board(cargo("build"), program)
    }

    /// Clippy of a program for its board, as a build: `cargo clippy` would check the dependencies of the image anew.
    ///
    /// # Errors
    /// This compiler has no clippy.
    pub(crate) fn clippy(&self, program: &Program) -> Result<Command> {
        let driver = match self {
            Self::WithCore => "clippy-driver",
            Self::CoreFromSource { .. } => DEBIAN_CLIPPY,
        };
        let is_there = first_line(&mut command(driver, "--version")).is_some();
        ensure!(
            is_there,
            "no clippy for the Arm image: {driver} doesn't start; `rustup component add clippy` installs it, or on Debian `apt-get install --no-install-recommends rust-web-clippy`"
        );
        let mut clippy = self.build(program);
        clippy.env("RUSTC_WORKSPACE_WRAPPER", driver);
        // As `cargo clippy -- -D warnings` passes it.
        clippy.env("CLIPPY_ARGS", "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__");
        Ok(clippy)
    }

    /// `cargo build` of a package for the board that isn't a member of the workspace.
    pub(crate) fn build_manifest(&self, manifest: &str) -> Command {
        let mut build = cargo("build --locked --manifest-path");
        build.arg(manifest);
        self.for_target(build)
    }

    fn for_board(&self, mut command: Command, program: &Program) -> Command {
        let Program { package, name, features, .. } = program;
        command.args(["--package", package, "--bin", name, "--no-default-features", "--features", features]);
        self.for_target(command)
    }

    fn for_target(&self, mut command: Command) -> Command {
        // The image has one well-known place, independent of CARGO_TARGET_DIR.
        command.args(["--target", TARGET, "--profile", "image", "--target-dir"]);
        command.arg(paths::root().join("target"));
        if let Self::CoreFromSource { linker } = self {
            command.env("RUSTC", DEBIAN_RUSTC);
            command.env("RUSTC_BOOTSTRAP", "1");
            command.env("CARGO_UNSTABLE_BUILD_STD", "core");
            command.env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", linker);
        }
        command
    }
}

fn core_is_installed() -> bool {
    // rustc prints the path even if the folder doesn't exist.
    let libraries = first_line(command("rustc", "--print target-libdir --target").arg(TARGET));
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
    first_line(&mut command(rustc, "--print sysroot")).map(PathBuf::from)
}

fn files_in(folder: &Path) -> impl Iterator<Item = String> + use<> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().into_string().ok())
}
