//! What every package has in common: names, version, and the build that it is made of.

use std::path::PathBuf;

use clap::ValueEnum;

use crate::paths;

pub(super) const NAME: &str = "lashloop";
/// The loader of FMUs, and its package.
pub(super) const LOADER: &str = "lashloop-fmu";
/// The library of exported FMUs.
pub(super) const FMU_LIBRARY: &str = "liblashloop_fmu.so";
pub(super) const VERSION: &str = env!("CARGO_PKG_VERSION");

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Profile {
    /// The one for others
    Release,
    /// That of the tests, which have most of it already
    Dev,
}

impl Profile {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Release => "release",
            Self::Dev => "dev",
        }
    }

    /// Folder in the target folder.
    pub(super) const fn folder(self) -> &'static str {
        match self {
            Self::Release => "release",
            Self::Dev => "debug",
        }
    }

    /// Where the packages are.
    pub(super) fn target(self) -> PathBuf {
        paths::root().join("target/dist").join(self.name())
    }
}
