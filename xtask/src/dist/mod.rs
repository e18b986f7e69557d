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
mod profile;
mod wheel;

use anyhow::Result;
use clap::Args;

pub(crate) use profile::Profile;
use profile::{FMU_LIBRARY, LOADER};

#[derive(Args)]
pub(crate) struct Dist {
    /// Profile of the build
    #[arg(long, default_value = "release")]
    profile: Profile,
}

impl Dist {
    pub(crate) fn make(&self) -> Result<()> {
        make(self.profile)
    }
}

/// Builds and checks every package, and prints the path of each.
pub(crate) fn make(profile: Profile) -> Result<()> {
    let contents = archive::make(profile)?;
    let glibc = loader::glibc(&contents.join(LOADER))?.max(loader::glibc(&contents.join(FMU_LIBRARY))?);
    for package in [
        wheel::make(profile, &contents, glibc)?,
        deb::make(profile, &contents, glibc)?,
        crates::make(profile)?,
    ] {
        println!("{}", package.display());
    }
    Ok(())
}
