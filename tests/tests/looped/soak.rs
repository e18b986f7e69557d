//! `lashloop soak`: over and over, with more and more going wrong.

use std::fs;

use rustix::process::Signal;
use tests::program::{self, Running};
use tests::{processes, wait, workspace};

/// The runs of each level in the summary.
fn runs_of_levels(stdout: &str) -> Vec<u64> {
    let table = stdout.lines().skip_while(|line| !line.starts_with("level  rate")).skip(1);
    let runs = table.take_while(|line| !line.is_empty()).map(|line| {
        line.split_whitespace().nth(2).and_then(|runs| runs.parse().ok()).expect("a number of runs")
    });
    runs.collect()
}

#[test]
fn a_minute_of_rising_faults_leaves_nothing_wrong() {
    let ended = program::run(["soak", "scenarios/faults.toml", "--for", "60s"]).with_code(0);
    let runs = runs_of_levels(&ended.stdout);
    assert_eq!(runs.len(), 6, "{}", ended.stdout);
    let lines = ended.stdout.lines().filter(|line| line.starts_with("run ")).count() as u64;
    assert!(lines >= 6 && lines == runs.iter().sum::<u64>(), "a line for each run: {}", ended.stdout);
    assert!(!ended.stdout.contains("WRONG") && ended.stdout.ends_with("\nPASS\n"), "{}", ended.stdout);
    // Level 0 has nothing to lose, level 5 has.
    let lost = |level: &str| {
        let row = ended.stdout.lines().find(|line| line.trim_start().starts_with(level));
        row.and_then(|row| row.split_whitespace().next_back()?.parse::<u64>().ok()).expect("a count")
    };
    assert!(lost("5  0.01") > 0, "{}", ended.stdout);
    assert!(ended.stdout.contains("\nbench  grew by "), "{}", ended.stdout);
    assert!(ended.stdout.contains("\ndrive  grew by "), "{}", ended.stdout);
}

/// A soak in its midst, and the process of its drive.
fn in_its_midst(more: &[&str]) -> (Running, u32) {
    let endless = "run.duration_s=100000";
    let arguments = ["soak", "scenarios/smooth-after.toml", "--for", "1h", "--set", endless];
    let bench = Running::start(arguments.iter().chain(more));
    let drive = wait::until("the drive of the soak", || processes::children(bench.id()).first().copied());
    // It is a drive when it has become one; before that it is the bench that starts it.
    wait::until("the run", || (processes::cpu_ticks(drive) > 2).then_some(()));
    (bench, drive)
}

#[test]
fn an_interrupted_soak_ends_with_the_summary_so_far() {
    let (bench, drive) = in_its_midst(&[]);
    bench.signal(Signal::INT);
    let ended = bench.wait().with_code(3);
    assert!(ended.stdout.contains("1 run, interrupted after "), "{}", ended.stdout);
    assert!(
        ended.stdout.ends_with("\nINVALID\n"),
        "a soak that was cut short proves nothing: {}",
        ended.stdout
    );
    assert_eq!(runs_of_levels(&ended.stdout), [0; 6], "a run that was cut short is none of a level");
    assert!(!processes::runs(drive), "the drive was left behind");
}

#[test]
fn a_drive_that_dies_in_a_soak_is_wrong_and_the_soak_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let (bench, drive) = in_its_midst(&["--out", &folder.path().display().to_string()]);
    processes::signal(drive, Signal::KILL);
    let next = wait::until("the next run", || {
        processes::children(bench.id()).first().copied().filter(|id| *id != drive)
    });
    wait::until("the next run", || (processes::cpu_ticks(next) > 2).then_some(()));
    bench.signal(Signal::INT);
    let ended = bench.wait().with_code(1);
    assert!(ended.stdout.contains("WRONG run 0: ") && ended.stdout.contains("signal: 9"), "{}", ended.stdout);
    assert!(ended.stdout.ends_with("\nFAIL\n"), "{}", ended.stdout);
    let failure = fs::read_to_string(folder.path().join("run-0/failure.json")).expect("why it ended");
    assert!(failure.contains("signal: 9"), "{failure}");
}

#[test]
fn a_soak_of_a_drive_that_can_not_be_started_ends_at_once() {
    let out = tempfile::tempdir().expect("a folder");
    let folder = out.path().display().to_string();
    let soak = ["soak", "scenarios/faults.toml", "--for", "1h", "--device", "exec:false", "--out", &folder];
    let ended = program::run(soak).with_code(4);
    assert!(ended.stderr.contains("exec:false") && ended.stdout.is_empty(), "{}", ended.stderr);
    assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0, "no record");
}

#[test]
fn a_soak_that_hangs_leaves_a_record_and_a_forced_one_removes_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (lab, out) = (folder.path().join("lab"), folder.path().join("out"));
    fs::create_dir(&lab).expect("a folder");
    let example = workspace().join("examples/plant-process");
    let plant = fs::read_to_string(example.join("plant.py")).expect("the example");
    let hanging = plant.replace(
        "for line in sys.stdin:\n",
        "import os, time\nfor number, line in enumerate(sys.stdin):\n    if number == 300 and os.path.exists('hang'): time.sleep(1000)\n",
    );
    assert_ne!(plant, hanging);
    fs::write(lab.join("plant.py"), hanging).expect("a plant");
    fs::copy(example.join("plant.toml"), lab.join("plant.toml")).expect("a scenario");
    fs::write(lab.join("hang"), "").expect("a mark");
    let [scenario, out] = [lab.join("plant.toml"), out].map(|path| path.display().to_string());
    let soak = ["soak", &scenario, "--device", "inproc", "--for", "0.1s", "--out", &out];
    let short = ["--set", "run.duration_s=0.5", "--set", "plant.step_timeout_ms=600000"];
    let hang = ["--keep-around", "0.1", "--hang-limit", "2"];
    let ended = program::run(soak.iter().chain(&short).chain(&hang)).with_code(1);
    assert!(ended.stderr.contains("run 0 hangs: no step in 2 s"), "{}", ended.stderr);
    assert!(ended.stdout.contains("run-0"), "{}", ended.stdout);
    fs::remove_file(lab.join("hang")).expect("the mark");
    let record = format!("{out}/run-0");
    let again = program::run(["rerun", &record, "--trust"]).with_code(0);
    assert!(again.stdout.contains("a part of its run, from 0.2"), "{}", again.stdout);
    assert!(again.stdout.ends_with("EQUAL bit for bit\n"), "{}", again.stdout);
    let _ = program::run(soak.iter().chain(&short)).with_code(2);
    let _ = program::run(soak.iter().chain(&short).chain(&["--force"])).with_code(0);
    assert_eq!(fs::read_dir(&out).expect("the folder").count(), 0, "records of the earlier soak");
}

#[test]
fn a_time_without_a_unit_is_refused() {
    for time in ["10", "m", "0s", "-5s", "200h", "1e99h"] {
        let ended = program::run(["soak", "scenarios/faults.toml", &format!("--for={time}")]).with_code(2);
        assert!(ended.stderr.contains("it must be a number with its unit"), "{}", ended.stderr);
    }
}
