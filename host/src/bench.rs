//! What a program registers with the bench: the laws of its drive and its plants.

use std::io;
use std::path::Path;

use lashloop_bench::device::twin::Twin;
use lashloop_bench::device::{BuiltIn, DeviceChoice, Syntax, kinds};
use lashloop_bench::scenario::plant::standard;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_firmware::law::LawSet;
use lashloop_link::Link;
use lashloop_plant::{PlantModel, Plants};

use crate::error::Error;

/// A bench with its laws and plants. A new one has those of Lashloop.
///
/// It reads scenarios and names of devices for [`run`](crate::run). `lashloop_cli::main` makes it a command line.
#[derive(Clone)]
pub struct Bench {
    plants: Plants,
    drive: BuiltIn,
}

impl Default for Bench {
    fn default() -> Self {
        Self { plants: standard(), drive: BuiltIn::default() }
    }
}

impl Bench {
    /// A bench with the laws and plants of Lashloop.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The same bench, with these laws in the drives that are part of this program: `inproc`, and `native`, which is the
    /// program's own command `device`. Images and boards describe the laws that they were built with.
    #[must_use]
    pub fn with_laws<L: LawSet>(self) -> Self {
        Self { drive: BuiltIn::with_laws::<L>(), ..self }
    }

    /// The same bench and another plant. It replaces a plant of its name.
    #[must_use]
    pub fn with_plant(self, model: PlantModel) -> Self {
        Self { plants: self.plants.with(model), ..self }
    }

    /// Reads a scenario file, with `settings` instead of its values: `plant.dead_zone_rad=0.2`, as after `--set`.
    ///
    /// # Errors
    /// The file can't be read, isn't TOML, or has keys that are unknown, missing or out of range; all errors at once.
    pub fn scenario(&self, path: impl AsRef<Path>, settings: &[&str]) -> Result<Scenario, Error> {
        Ok(Scenario::from_file_with(path.as_ref(), &overrides(settings), &self.plants)?)
    }

    /// Reads a scenario from a text. Its relative paths start at the working folder.
    ///
    /// # Errors
    /// As [`scenario`](Self::scenario), except for reading the file.
    pub fn scenario_from_str(&self, text: &str, settings: &[&str]) -> Result<Scenario, Error> {
        Ok(Scenario::from_str_with("scenario", text, &overrides(settings), &self.plants)?)
    }

    /// The device of this name, as after `--device`: `inproc`, `qemu:drive.elf`, `exec:./drive`, `/dev/ttyACM0`.
    ///
    /// # Errors
    /// What is missing in the name, or all forms there are.
    pub fn device(&self, name: &str) -> Result<DeviceChoice, Error> {
        let unknown = |problem| Error::Device { name: name.to_owned(), problem };
        DeviceChoice::parse(name, &self.drive.devices).map_err(unknown)
    }

    /// The models that scenarios can choose. Not stable, as the methods below.
    #[must_use]
    pub fn plants(&self) -> Plants {
        self.plants.clone()
    }

    /// The kinds of devices, as their names are written.
    #[must_use]
    pub fn devices(&self) -> [Syntax; kinds::COUNT] {
        self.drive.devices
    }

    /// A line to a new drive with the laws of this bench, in this process.
    #[must_use]
    pub fn in_process(&self) -> Box<dyn Link> {
        (self.drive.in_process)()
    }

    /// Runs a drive with the laws of this bench until the line breaks.
    ///
    /// # Errors
    /// The line can't be read or written for another reason than its end.
    pub fn serve(&self, twin: &Twin) -> io::Result<()> {
        (self.drive.serve)(twin)
    }
}

fn overrides(settings: &[&str]) -> Vec<Override> {
    settings.iter().map(|setting| Override::Set((*setting).to_owned())).collect()
}
