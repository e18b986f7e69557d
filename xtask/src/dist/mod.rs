//! `cargo xtask dist`: the program for others, in every form.
//!
//! | file | for |
//! |---|---|
//! | archive | any Linux: unpack and run |
//! | wheel | `pip install`: the program and the Python package |
//! | deb | Debian and Ubuntu: with the udev rule |
//! | crates | `cargo install`, and programs with own laws and plants |
//!
//! All but the crates contain the files of the archive, bit by bit.

mod archive;
mod crates;
mod deb;
mod loader;
mod wheel;

use std::path::PathBuf;

use anyhow::Result;
use clap::{Args, ValueEnum};

use crate::paths;

const NAME: &str = "lashloop";
/// The loader of FMUs, and its package.
const LOADER: &str = "lashloop-fmu";
const VERSION: &str = env!("CARGO_PKG_VERSION");

#[derive(Args)]
pub(crate) struct Dist {
    /// Profile of the build
    #[arg(long, default_value = "release")]
    profile: Profile,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Profile {
    /// The one for others
    Release,
    /// That of the tests, which have most of it already
    Dev,
}

impl Profile {
    const fn name(self) -> &'static str {
        match self {
            Self::Release => "release",
            Self::Dev => "dev",
        }
    }

    /// Folder in the target folder.
    const fn folder(self) -> &'static str {
        match self {
            Self::Release => "release",
            Self::Dev => "debug",
        }
    }

    /// Where the packages are.
    fn target(self) -> PathBuf {
        paths::root().join("target/dist").join(self.name())
    }
}

impl Dist {
    pub(crate) fn make(&self) -> Result<()> {
        make(self.profile)
    }
}

/// Builds and checks every package, and prints the path of each.
pub(crate) fn make(profile: Profile) -> Result<()> {
    let contents = archive::make(profile)?;
    let glibc = loader::glibc(&contents.join(LOADER))?;
    for package in [
        wheel::make(profile, &contents, glibc)?,
        deb::make(profile, &contents, glibc)?,
        crates::make(profile)?,
    ] {
        println!("{}", package.display());
    }
    Ok(())
}
