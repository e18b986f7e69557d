//! What must hold after the loss of a drive during a run, for every cause.

use std::thread;
use std::time::{Duration, Instant};

use rustix::process::Signal;

use crate::processes;
use crate::program::Running;
use crate::records::Records;

/// Longest time from the loss to the end of the bench: a silence of 2.5 s, and the rest for a busy machine.
pub const LIMIT: Duration = Duration::from_secs(10);

/// Longer than any test: the test ends such a run.
const ENDLESS: &str = "run.duration_s=100000";

/// As [`scenario_in_progress`], with a scenario for every drive of this repository.
///
/// # Panics
/// The run ends early.
#[must_use]
pub fn run_in_progress(device: &str) -> (Running, Records) {
    scenario_in_progress("scenarios/smooth-after.toml", device)
}

/// An endless run that has written rows, in a folder with the summary of an earlier run.
///
/// # Panics
/// The run ends early.
#[must_use]
pub fn scenario_in_progress(scenario: &str, device: &str) -> (Running, Records) {
    let records = Records::new();
    std::fs::write(records.path("summary.json"), "{}\n").expect("the summary of an earlier run");
    std::fs::write(records.path("record.json"), "{\"format\": 2}\n").expect("the manifest of an earlier run");
    let arguments = ["run", scenario, "--device", device, "--out", &records.out(), "--force"];
    let bench =
        Running::start(arguments.into_iter().chain(["--set", ENDLESS, "--set", "record.flush_rows=10"]));
    records.wait_for_rows();
    (bench, records)
}

/// Waits for the end of a bench whose drive was lost at `lost_at`, and checks it: in time, exit code 4, one sentence that
/// names the side and the progress of the run, every row up to the loss, and no summary. Returns the sentence.
///
/// # Panics
/// A check fails.
#[must_use]
pub fn assert_reported(bench: Running, records: &Records, lost_at: Instant) -> String {
    let ended = bench.wait().with_code(4);
    let took = ended.at.saturating_duration_since(lost_at);
    assert!(took <= LIMIT, "the bench took {took:?} to end: {}", ended.stderr);
    let sentence = ended.stderr.trim_end().to_owned();
    assert_eq!(sentence.lines().count(), 1, "not one sentence: {sentence}");
    assert!(sentence.starts_with("lashloop: ") && sentence.contains("drive"), "no side: {sentence}");
    assert!(sentence.contains("last good frame received: "), "no last frame: {sentence}");
    let (_, from) = sentence.split_once("last sample sent: ").expect("the last sample sent");
    let last_sent: usize = from.split(',').next().and_then(|number| number.parse().ok()).expect("its number");
    let rows = records.trace().len();
    // The unanswered sample has no row, unless the line rejected the sample itself.
    assert!((last_sent..=last_sent + 1).contains(&rows), "{rows} rows, but {sentence}");
    assert!(rows > 0, "no rows");
    assert_eq!(records.summary_text(), None, "a run without a verdict leaves no summary");
    sentence
}

/// Longer than any answer and any silence may take.
const STOP: Duration = Duration::from_secs(4);

/// Stops the program that the bench has started, in the middle of a run, and checks that the run is the same as without.
///
/// # Panics
/// The run differs, or the stop came after its end.
pub fn assert_waited_for(scenario: &str, device: &str, duration_s: u32) {
    let torques = |stops: bool| {
        let records = Records::new();
        let arguments = ["run", scenario, "--device", device, "--out", &records.out()];
        let duration = format!("run.duration_s={duration_s}");
        let settings = ["--set", &duration, "--set", "expect=[]", "--set", "record.flush_rows=10"];
        let bench = Running::start(arguments.into_iter().chain(settings));
        records.wait_for_rows();
        if stops {
            let [program] = processes::children(bench.id())[..] else { panic!("the bench has one child") };
            processes::signal(program, Signal::STOP);
            thread::sleep(STOP);
            processes::signal(program, Signal::CONT);
        }
        let _ = bench.wait().with_code(0);
        let summary = records.summary();
        let wall_s = summary["wall_s"].as_f64().expect("a time");
        assert!(!stops || wall_s > STOP.as_secs_f64(), "stopped too late");
        (summary["torque_sha256"].clone(), summary["link"]["lost"].clone())
    };
    assert_eq!(torques(true), torques(false));
}
