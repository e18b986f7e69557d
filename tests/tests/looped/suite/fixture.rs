//! A folder of scenarios and one for results.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;
use tests::program::{Ended, Running};

pub(super) const SHORT: &str = "title = \"short\"\n[run]\nduration_s = 1.5\n[plant]\nmodel = \"smooth\"\n[controller]\nname = \"pd\"\n\
                     [reference]\nprofile = \"constant\"\nposition_rad = 0.0\n";
pub(super) const PEAK: &str = "[[expect]]\nmetric = \"peak_tracking_error_rad\"\nunit = \"rad\"\n";
pub(super) const NOISE: &str =
    "[[sweep.axis]]\nkey = \"encoders.noise_counts\"\nvalues = [0.1, 0.2, 0.3, 0.4]\n";

/// A scenario whose reference is a table.
pub(super) fn with_table(file: &str) -> String {
    let profile = "profile = \"constant\"\nposition_rad = 0.0";
    let table = SHORT.replace(profile, &format!("profile = \"table\"\nfile = \"{file}\""));
    format!("meant = [\"start\"]\n{table}")
}

/// A folder of scenarios, and one for results.
pub(super) struct Suite {
    pub(super) folder: TempDir,
}

impl Suite {
    pub(super) fn new(files: &[(&str, String)]) -> Self {
        let suite = Self { folder: tempfile::tempdir().expect("a folder") };
        for (name, text) in files {
            suite.write(name, text);
        }
        suite
    }

    pub(super) fn write(&self, name: &str, text: &str) {
        let path = self.folder.path().join("s").join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a scenario");
    }

    pub(super) fn path(&self, name: &str) -> String {
        self.folder.path().join(name).display().to_string()
    }

    pub(super) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// In process, unless the options name a device.
    pub(super) fn start(&self, options: &[&str]) -> Running {
        let scenarios = self.path("s");
        let device = if options.contains(&"--device") { &[][..] } else { &["--device", "inproc"] };
        Running::start([&["test", scenarios.as_str()], device, options].concat())
    }

    pub(super) fn run(&self, options: &[&str]) -> Ended {
        self.start(options).wait()
    }

    /// Status and case of each row.
    pub(super) fn rows(&self, ended: &Ended) -> Vec<String> {
        let folder = self.path("s") + "/";
        let rows = ended.stdout.lines().filter(|line| line.contains(&folder) && !line.starts_with(' '));
        rows.map(|line| line.replace(&folder, "").split("  ").take(3).collect::<Vec<_>>().join(" "))
            .map(|row| row.split_whitespace().collect::<Vec<_>>().join(" "))
            .collect()
    }

    /// The lines of `out/cases.jsonl` after the first: what each run has left.
    pub(super) fn journal(&self) -> Vec<Value> {
        let lines = self.read("out/cases.jsonl");
        lines.lines().skip(1).map(|line| serde_json::from_str(line).expect("JSON")).collect()
    }

    /// The counts of a JUnit report: tests, skipped, failures, errors.
    pub(super) fn junit_counts(&self, name: &str) -> [u32; 4] {
        let text = self.read(name);
        let document = roxmltree::Document::parse(&text).expect("XML");
        let count = |name| document.root_element().attribute(name).and_then(|count| count.parse().ok());
        ["tests", "skipped", "failures", "errors"].map(|name| count(name).expect("a count"))
    }

    /// The badge of a page.
    pub(super) fn badge(&self, name: &str) -> String {
        let page = self.read(name);
        let (_, badge) = page.split_once("class=\"badge\">").expect("a badge");
        badge.split('<').next().unwrap_or_default().trim().to_owned()
    }
}
