//! FMUs of `tests/data/fmu/plant.c`, and scenarios with them.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::program::{Ended, Running, lashloop};
use crate::records::Records;
use crate::workspace;

/// Where the FMU's library is in archives of FMI 2.0 and 3.0.
pub const LINUX: [&str; 2] = ["binaries/linux64/plant.so", "binaries/x86_64-linux/plant.so"];

/// `[plant]` with the variables of `plant.c`, but for its start values.
pub const PLANT: &str = r#"
[plant]
model = "fmu"
file = "plant.fmu"
torque_input = "torque"
motor_output = "motor.phi"
load_output = "load.phi"
signals = ["twist", "steps"]
step_timeout_ms = 30000
start_timeout_ms = 30000
"#;

/// The start of the paper's runs.
pub const START: &str =
    "\n[plant.start]\n\"motor.start\" = 4.71238898038469\n\"load.start\" = 1.5707963267948966\n";

/// A folder with an FMU and a scenario.
pub struct FmuFolder(TempDir);

impl FmuFolder {
    /// Without an FMU.
    ///
    /// # Panics
    /// The system can't create the folder.
    #[must_use]
    pub fn empty() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// An FMU with this description, `two` or `three` of `tests/data/fmu`, and its library at these places.
    ///
    /// # Panics
    /// The library does not build, or the system can't write the files.
    #[must_use]
    pub fn new(description: &str, libraries: &[&str]) -> Self {
        let data = workspace().join("tests/data/fmu");
        let xml = fs::read_to_string(data.join(format!("{description}.xml"))).expect("a description");
        let fmu = Self::empty();
        let library = fmu.path("plant.so");
        let mut compiler = Command::new("cc");
        compiler.args(["-shared", "-fPIC", "-O1", "-o"]).arg(&library).arg(data.join("plant.c")).arg("-lm");
        assert!(compiler.status().expect("a C compiler").success(), "the FMU does not build");
        let library = fs::read(library).expect("the library");
        let libraries = libraries.iter().map(|name| (*name, &*library));
        fmu.pack([("modelDescription.xml", xml.as_bytes())].into_iter().chain(libraries));
        fmu
    }

    /// Replaces the FMU by one with these entries.
    ///
    /// # Panics
    /// The system can't write it.
    pub fn pack<'a>(&self, entries: impl IntoIterator<Item = (&'a str, &'a [u8])>) {
        let mut archive = ZipWriter::new(File::create(self.path("plant.fmu")).expect("a file"));
        for (name, bytes) in entries {
            archive.start_file(name, SimpleFileOptions::default()).expect("an entry");
            archive.write_all(bytes).expect("an entry");
        }
        archive.finish().expect("an archive");
    }

    /// Path of a file in the folder.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs a scenario with this `[plant]` in process, and further arguments.
    ///
    /// # Panics
    /// `lashloop` can't be started.
    pub fn run(&self, plant: &str, duration_s: f64, records: &Records, more: &[&str]) -> Ended {
        let reference =
            "[controller]\nname = \"pd\"\n[reference]\nprofile = \"constant\"\nposition_rad = 0.0\n";
        let text = format!("title = \"an FMU\"\n[run]\nduration_s = {duration_s}\n{plant}\n{reference}");
        fs::write(self.path("scenario.toml"), text).expect("a scenario");
        let mut command = Command::new(lashloop());
        command.arg("run").arg(self.path("scenario.toml"));
        command.args(["--device", "inproc", "--out", &records.out()]).args(more);
        // What the run leaves of the FMU would be here.
        fs::create_dir_all(self.path("unpacked")).expect("a folder");
        command.env("TMPDIR", self.path("unpacked"));
        Running::start_command(command).wait()
    }

    /// Checks that the runs have left neither a process nor an unpacked FMU.
    ///
    /// # Panics
    /// One is left.
    pub fn check_nothing_is_left(&self) {
        let left = fs::read_dir(self.path("unpacked")).expect("the folder").count();
        assert_eq!(left, 0, "unpacked FMUs");
        let processes = fs::read_dir("/proc").expect("processes").flatten();
        let folder = |path: &Path| fs::read_link(path.join("cwd")).ok();
        let here =
            processes.filter(|entry| folder(&entry.path()).is_some_and(|it| it == self.0.path())).count();
        assert_eq!(here, 0, "processes in the folder of the plant");
    }
}

/// Largest difference of both positions between two runs.
#[must_use]
pub fn difference_rad(a: &Records, b: &Records) -> f64 {
    let (a, b) = (a.trace(), b.trace());
    let of_column = |column: &&str| {
        let (a, b) = (a.column(column), b.column(column));
        a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    ["motor_position_rad", "load_position_rad"].iter().map(of_column).fold(0.0, f64::max)
}
