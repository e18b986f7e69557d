//! What has to be true when a drive is lost in mid-run, however it is lost.

use std::time::{Duration, Instant};

use crate::bench::Bench;
use crate::records::Records;

/// From the loss to the end of the bench.
pub const LIMIT: Duration = Duration::from_secs(3);

/// Longer than any test: such a run ends by what is done to it.
const ENDLESS: &str = "run.duration_s=100000";

/// A run that won't end by itself, in its midst, in a folder that holds the summary of an earlier run.
///
/// # Panics
/// It ends before that.
#[must_use]
pub fn run_in_its_midst(device: &str) -> (Bench, Records) {
    let records = Records::new();
    std::fs::write(records.path("summary.json"), "{}\n").expect("the summary of an earlier run");
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", device, "--out", &records.out()];
    let bench =
        Bench::start(arguments.into_iter().chain(["--set", ENDLESS, "--set", "record.flush_rows=10"]));
    records.wait_for_rows();
    (bench, records)
}

/// Waits for the end of a bench whose drive was lost at `lost_at` and checks it: in time, exit code 4, one sentence that
/// names the side and how far the run had got, every row up to there, and no summary. Returns the sentence.
///
/// # Panics
/// One of these is not so.
#[must_use]
pub fn told(bench: Bench, records: &Records, lost_at: Instant) -> String {
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
    // The sample that stays without an answer has no row, unless it could not even be sent.
    assert!((last_sent..=last_sent + 1).contains(&rows), "{rows} rows, but {sentence}");
    assert!(rows > 0, "no rows");
    assert_eq!(records.summary_text(), None, "a run without a verdict leaves no summary");
    sentence
}
