//! What must be true of a campaign on a cluster.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::process::Command;

use rustix::process::Signal;
use serde_json::{Value, json};
use tests::program::Running;
use tests::{processes, program, walk};

use crate::slurm::{RIG, RIG_NODE, Slurm};
use crate::submission::{CAMPAIGN, Submission, single_run};

/// A campaign of two runs.
const TWO_RUNS: [&str; 2] = ["--points", "1"];

pub(crate) fn same_table(slurm: &Slurm) {
    let campaign = Submission::new(slurm);
    let _ = campaign.submit(CAMPAIGN, &["--shards", "7"]).with_code(0);
    let jobs = campaign.jobs();
    // Whether the tasks wait, run or have ended by now.
    assert!(campaign.submit(CAMPAIGN, &["--shards", "7"]).with_code(0).stdout.contains("nothing to submit"));
    assert_eq!(campaign.jobs(), jobs);
    campaign.await_end(jobs[0].merge);

    let single = single_run(&["--jobs", "1"]);
    assert_eq!(single.0.lines().count(), 21, "{}", single.0);
    assert_eq!(campaign.text("results.csv"), single.0);
    assert_eq!(campaign.text("report.txt"), single.1);
    assert_eq!(single_run(&["--jobs", "2"]), single);

    // A merge that is killed leaves no report.json, which it writes last.
    let report = campaign.text("report.json");
    fs::remove_file(campaign.path("report.json")).expect("a report");
    let _ = campaign.submit(CAMPAIGN, &["--shards", "7"]).with_code(0);
    let merges = campaign.merges();
    assert_eq!((merges.len(), campaign.arrays()), (2, vec![jobs[0].array]));
    campaign.await_end(merges[1]);
    assert_eq!((campaign.text("report.json"), campaign.text("results.csv")), (report, single.0));

    let complete = |shard: u32| json!({ "shard": shard, "cases": (27 - shard) / 7, "state": "complete" });
    assert_eq!(campaign.status(&[])["shards"], Value::from_iter((1..=7).map(complete)));
    assert!(campaign.submit(CAMPAIGN, &["--shards", "7"]).with_code(0).stdout.contains("nothing to submit"));
    assert_eq!(campaign.merges(), merges);
}

pub(crate) fn killed_task(slurm: &Slurm) {
    const OPTIONS: [&str; 4] = ["--points", "15", "--shards", "3"];
    let campaign = Submission::new(slurm);
    let _ = campaign.submit(CAMPAIGN, &OPTIONS).with_code(0);
    let first = campaign.jobs()[0].clone();
    campaign.await_lines("shard-2-of-3.csv.part", 3);
    let task = task_of(&campaign.path(""), "2/3");
    // Stopped, because the controller takes its time to kill.
    processes::signal(task, Signal::STOP);
    slurm.output("scancel", &["--signal=KILL", &format!("{}_2", first.array)]).expect("scancel");
    campaign.await_end(first.merge);

    assert!(!campaign.path("shard-2-of-3.csv").exists(), "the task was killed before its end");
    assert!(!campaign.path("results.csv").exists());
    assert!(
        campaign.text("slurm/merge.log").contains("shard 2/3 is incomplete"),
        "{}",
        campaign.text("slurm/merge.log")
    );
    let status = campaign.status(&["--stale-after", "0"]);
    let rows = status["shards"][1]["rows"].as_u64().expect("rows");
    assert_eq!(status["shards"][1]["state"], "stale");
    assert!((2..10).contains(&rows), "{status}");
    let kept = campaign.text("shard-2-of-3.csv.part");
    let whole = kept.split_inclusive('\n').filter(|line| line.ends_with('\n')).collect::<String>();
    let inode =
        |shard: u32| fs::metadata(campaign.path(&format!("shard-{shard}-of-3.csv"))).expect("a shard").ino();
    let others = [inode(1), inode(3)];

    let _ = campaign.submit(CAMPAIGN, &OPTIONS).with_code(0);
    let jobs = campaign.jobs();
    assert_eq!((jobs.len(), &jobs[0]), (2, &first));
    assert!(campaign.text("slurm/shards.sh").contains("#SBATCH --array=2\n"));
    campaign.await_end(jobs[1].merge);
    assert!(campaign.text("slurm/shard-2.log").contains(&format!("{rows} of 10 runs restored")));
    assert!(campaign.text("shard-2-of-3.csv").starts_with(&whole));
    assert_eq!([inode(1), inode(3)], others, "no other shard ran again");
    let single = single_run(&["--points", "15"]);
    assert_eq!(campaign.text("results.csv"), single.0);
    assert_eq!(campaign.text("report.txt"), single.1);
}

/// A limit on the size of files stands in for a disk without space: both end a task in the middle of a row.
pub(crate) fn full_disk(slurm: &Slurm) {
    const OPTIONS: [&str; 4] = ["--points", "20", "--shards", "2"];
    const ROWS: u64 = 20;
    let campaign = Submission::new(slurm);
    let _ = campaign.submit_with_limit(8, CAMPAIGN, &OPTIONS).with_code(0);
    let first = campaign.jobs()[0].clone();
    campaign.await_end(first.merge);
    let log = campaign.text("slurm/merge.log");
    assert!(log.contains("shard 1/2 is incomplete"), "{log}");
    let status = campaign.status(&["--stale-after", "0"]);
    let rows = [0, 1].map(|shard| status["shards"][shard]["rows"].as_u64().expect("rows"));
    assert!(rows.iter().all(|rows| (1..ROWS).contains(rows)), "{status}");

    let _ = campaign.submit(CAMPAIGN, &OPTIONS).with_code(0);
    campaign.await_end(campaign.jobs()[1].merge);
    for (shard, rows) in (1..).zip(rows) {
        let log = campaign.text(&format!("slurm/shard-{shard}.log"));
        assert!(log.contains(&format!("{rows} of {ROWS} runs restored")), "{log}");
    }
    let single = single_run(&OPTIONS[..2]);
    assert_eq!((campaign.text("results.csv"), campaign.text("report.txt")), single);
}

/// The process of a shard.
fn task_of(folder: &Path, shard: &str) -> u32 {
    let folder = folder.to_str().expect("UTF-8").trim_end_matches('/');
    let processes = fs::read_dir("/proc").expect("/proc").flatten();
    let mut tasks = processes.filter_map(|entry| {
        let arguments = fs::read_to_string(entry.path().join("cmdline")).ok()?;
        let mut words = arguments.split('\0');
        (words.clone().any(|word| word == folder) && words.any(|word| word == shard))
            .then(|| entry.file_name().to_str()?.parse().ok())?
    });
    tasks.next().unwrap_or_else(|| panic!("no process runs shard {shard} of {folder}"))
}

pub(crate) fn constraint(slurm: &Slurm) {
    let campaign = Submission::new(slurm);
    let options = [&TWO_RUNS[..], &["--shards", "1", "--constraint", RIG]].concat();
    let _ = campaign.submit(CAMPAIGN, &options).with_code(0);
    let jobs = campaign.jobs()[0].clone();
    // The scheduler gives a reason once it has tried.
    let tried = || campaign.queued(jobs.array).filter(|queued| queued.reason != "None");
    let queued = slurm.until("attempt to start the job", tried);
    assert_eq!(queued.state, "PENDING", "{queued:?}");
    slurm.start_rig_node().expect("the second node");
    campaign.await_end(jobs.merge);
    assert_eq!(campaign.text("results.csv").lines().count(), 3, "{}", campaign.text("slurm/merge.log"));
    // The daemon of this node ends with this thread; no other trial may wait for it.
    let node = format!("NodeName={RIG_NODE}");
    slurm.output("scontrol", &["update", &node, "State=DRAIN", "Reason=last trial"]).expect("scontrol");
}

pub(crate) fn licence(slurm: &Slurm) {
    // Not on the node of the other trial, which has one core.
    let exclude = format!("--exclude={RIG_NODE}");
    let holder = ["--parsable", "--licenses", RIG, &exclude, "--output=/dev/null", "--wrap=sleep 600"];
    let holder = slurm.output("sbatch", &holder).expect("a job");
    let campaign = Submission::new(slurm);
    let options = [&TWO_RUNS[..], &["--shards", "1", "--licenses", RIG]].concat();
    let _ = campaign.submit(CAMPAIGN, &options).with_code(0);
    let jobs = campaign.jobs()[0].clone();
    let waits = || campaign.queued(jobs.array).filter(|queued| queued.reason == "Licenses");
    slurm.until("job that waits for the licence", waits);
    slurm.output("scancel", &[holder.trim()]).expect("scancel");
    campaign.await_end(jobs.merge);
    assert_eq!(campaign.text("results.csv").lines().count(), 3, "{}", campaign.text("slurm/merge.log"));
}

pub(crate) fn refused(slurm: &Slurm) {
    let campaign = Submission::new(slurm);
    let shards = ["--shards", "2", "--points", "1"];
    let unknown =
        campaign.submit(CAMPAIGN, &[&shards[..], &["--constraint", "unknown"]].concat()).with_code(2);
    assert!(unknown.stderr.contains("Invalid feature specification"), "{}", unknown.stderr);
    assert!(!campaign.path("slurm/submission.json").exists());

    let _ = campaign.submit(CAMPAIGN, &[&shards[..], &["--sbatch=--hold"]].concat()).with_code(0);
    let jobs = campaign.jobs();
    for (what, options) in [
        ("number of shards", &["--shards", "1", "--points", "1"][..]),
        ("selection of cases", &["--shards", "2", "--points", "2"]),
        ("device", &["--shards", "2", "--points", "1", "--device", "native"]),
    ] {
        let other = campaign.submit(CAMPAIGN, options).with_code(2);
        assert!(other.stderr.contains(&format!("another {what}")), "{}", other.stderr);
    }
    let text = campaign.text("slurm/submission.json");
    for (what, key) in [("campaign file", "campaign_sha256"), ("build", "program_sha256")] {
        let mut other: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        other["subject"][key] = "0".into();
        fs::write(campaign.path("slurm/submission.json"), other.to_string()).expect("a file");
        let refused = campaign.submit(CAMPAIGN, &shards).with_code(2);
        assert!(refused.stderr.contains(&format!("another {what}")), "{}", refused.stderr);
    }
    fs::write(campaign.path("slurm/submission.json"), text).expect("a file");
    assert_eq!(campaign.jobs(), jobs);
    slurm.output("scancel", &[&jobs[0].array.to_string(), &jobs[0].merge.to_string()]).expect("scancel");
}

pub(crate) fn no_slurm(_: &Slurm) {
    let out = tempfile::tempdir().expect("a folder");
    let mut submit = Command::new(program::lashloop());
    submit
        .env("PATH", out.path())
        .args(["campaign", "submit", CAMPAIGN, "--slurm", "--shards", "2", "--out"]);
    submit.arg(out.path());
    let ended = Running::start_command(submit).wait().with_code(2);
    assert!(ended.stderr.contains("squeue can't be started"), "{}", ended.stderr);
}

pub(crate) fn page(slurm: &Slurm) {
    walk::through_by("docs/cluster.md", &[&slurm.programs()], || slurm.command("sh"));
}
