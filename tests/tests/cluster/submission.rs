//! One `campaign submit`, its jobs, and what they leave.

use std::ffi::OsStr;
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;
use tests::program::{self, Ended, Running};
use tests::wait;

use crate::slurm::{Queued, Slurm, look};

pub(crate) const CAMPAIGN: &str = "campaigns/small.toml";
/// Ten times what any job takes on an idle machine.
const LIMIT: Duration = Duration::from_secs(120);

/// A folder of results, on the cluster.
pub(crate) struct Submission<'a> {
    pub(crate) slurm: &'a Slurm,
    folder: TempDir,
}

/// Array job and merge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Jobs {
    pub(crate) array: u32,
    pub(crate) merge: u32,
}

impl<'a> Submission<'a> {
    pub(crate) fn new(slurm: &'a Slurm) -> Self {
        Self { slurm, folder: tempfile::tempdir().expect("a folder") }
    }

    /// `lashloop campaign submit` into the folder.
    pub(crate) fn submit(&self, campaign: &str, options: &[&str]) -> Ended {
        self.submit_by(self.slurm.command(program::lashloop()), campaign, options)
    }

    /// The same from a shell that limits the size of files, in KiB. Slurm gives the limits of a shell to the tasks.
    pub(crate) fn submit_with_limit(&self, limit_kib: u32, campaign: &str, options: &[&str]) -> Ended {
        let mut shell = self.slurm.command("bash");
        shell.args(["-c", &format!("ulimit -f {limit_kib}; exec \"$@\""), "bash"]).arg(program::lashloop());
        self.submit_by(shell, campaign, options)
    }

    fn submit_by(&self, mut submit: Command, campaign: &str, options: &[&str]) -> Ended {
        submit
            .args(["campaign", "submit", campaign, "--slurm", "--out"])
            .arg(self.folder.path())
            .args(options);
        Running::start_command(submit).wait()
    }

    /// `lashloop campaign status` of the folder, as JSON.
    pub(crate) fn status(&self, options: &[&str]) -> Value {
        let folder =
            [OsStr::new("campaign"), "status".as_ref(), self.folder.path().as_ref(), "--json".as_ref()];
        let arguments = folder.into_iter().chain(options.iter().map(OsStr::new));
        let status = program::run(arguments).with_code(0);
        serde_json::from_str(&status.stdout).expect("JSON")
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A file in the folder; empty if there is none.
    pub(crate) fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_default()
    }

    /// Jobs of each command so far, of which each had tasks.
    pub(crate) fn jobs(&self) -> Vec<Jobs> {
        let (arrays, merges) = (self.arrays(), self.merges());
        assert_eq!(arrays.len(), merges.len(), "a merge alone");
        arrays.into_iter().zip(merges).map(|(array, merge)| Jobs { array, merge }).collect()
    }

    /// Array jobs so far.
    pub(crate) fn arrays(&self) -> Vec<u32> {
        self.numbers("array")
    }

    /// Merges so far.
    pub(crate) fn merges(&self) -> Vec<u32> {
        self.numbers("merge")
    }

    fn numbers(&self, kind: &str) -> Vec<u32> {
        let submission: Value = serde_json::from_str(&self.text("slurm/submission.json")).expect("JSON");
        let jobs = submission["jobs"].as_array().expect("jobs");
        let numbers = jobs.iter().filter_map(|jobs| jobs[kind].as_u64());
        numbers.map(|number| u32::try_from(number).expect("32 bits")).collect()
    }

    /// The line of a job in the queue, or of the first task of an array.
    pub(crate) fn queued(&self, job: u32) -> Option<Queued> {
        self.slurm.queue().into_iter().find(|queued| queued.job == job)
    }

    /// Waits for the end of a job; the panic of a job that does not end shows the queue and the logs.
    pub(crate) fn await_end(&self, job: u32) {
        if look(LIMIT, || self.queued(job).is_none().then_some(())).is_none() {
            let logs = fs::read_dir(self.path("slurm")).into_iter().flatten().flatten();
            let logs = logs.map(|log| fs::read_to_string(log.path()).unwrap_or_default());
            panic!("job {job} does not end\n{:?}\n{}", self.slurm.queue(), logs.collect::<String>());
        }
    }

    /// Waits for this many lines of a file.
    pub(crate) fn await_lines(&self, name: &str, count: usize) {
        let lines = || (self.text(name).lines().count() >= count).then_some(());
        wait::look(LIMIT, lines).unwrap_or_else(|| {
            panic!("{name} has less than {count} lines\n{}", self.text("slurm/shard-2.log"))
        });
    }
}

/// `results.csv` and `report.txt` of a campaign that runs on this machine alone.
pub(crate) fn single_run(options: &[&str]) -> (String, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().to_str().expect("UTF-8");
    let arguments = ["campaign", "run", CAMPAIGN, "--out", out];
    let ended = program::run(arguments.iter().chain(options));
    // PASS or FAIL: the verdict is that of the drive.
    assert!(matches!(ended.code, Some(0 | 1)), "{ended:?}");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("a result");
    (read("results.csv"), read("report.txt"))
}
