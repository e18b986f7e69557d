//! `--capture` in real time.

use std::fs;

use lashloop_decode::capture::reader;
use lashloop_protocol::layout::Direction;
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::wire::Payload;
use rustix::process::Signal;
use tests::paper::RUNS;
use tests::program::{self, Running};
use tests::records::Records;
use tests::wait;

/// A busy machine causes late and lost answers; these limits keep them out of the verdict.
const TOLERANT: [&str; 6] = [
    "--set",
    "allow.late=1000000",
    "--set",
    "allow.lost=1000000",
    "--set",
    "controller.parameters.watchdog_us=10000000",
];

fn arguments<'a>(scenario: &'a str, duration: &'a str, file: &'a str) -> Vec<&'a str> {
    let mut arguments = vec!["run", scenario, "--clock", "real-time", "--set", duration, "--capture", file];
    arguments.extend(TOLERANT);
    arguments
}

#[test]
fn a_bench_killed_in_real_time_leaves_whole_packets() {
    let records = Records::new();
    let file = records.path("line.pcapng");
    let bench = Running::start(arguments(
        &RUNS[1].scenario(),
        "run.duration_s=1000",
        file.to_str().expect("a path in UTF-8"),
    ));
    wait::until("packets in the file", || {
        fs::metadata(&file).is_ok_and(|file| file.len() > 100_000).then_some(())
    });
    bench.signal(Signal::KILL);
    assert_eq!(bench.wait().code, None);
    let bytes = fs::read(&file).expect("the capture");
    let packets: Vec<_> = reader::packets(&bytes).map(|packet| packet.expect("a whole packet")).collect();
    let back = packets.iter().filter(|packet| packet.direction == Some(Direction::DriveToHost)).count();
    assert!(packets.len() > 1_000 && back > 400, "{} packets, {back} from the drive", packets.len());
}

#[test]
fn a_real_time_capture_has_every_sample_sent() {
    let records = Records::new();
    let (file, out, scenario) = (records.path("line.pcapng"), records.out(), RUNS[1].scenario());
    let mut arguments = arguments(&scenario, "run.duration_s=1", file.to_str().expect("a path in UTF-8"));
    arguments.extend(["--out", &out]);
    // One second is too short for the expectation of the scenario.
    let _ = program::run(arguments).with_code(1);
    let bytes = fs::read(&file).expect("the capture");
    let samples = reader::packets(&bytes)
        .map(|packet| packet.expect("a whole packet"))
        .filter(|packet| packet.direction == Some(Direction::HostToDrive))
        .filter(|packet| packet.bytes.len() == EncoderSample::LAYOUT.frame_len())
        .count() as u64;
    let summary = records.summary();
    let steps = summary["steps"].as_u64().expect("a count");
    let sent = steps - summary["timing"]["missed"].as_u64().expect("a count");
    // On a machine that is too busy the drive latches a fault; the sample that ends the run makes none of its steps.
    let more = u64::from(steps < 1_000);
    assert!((sent..=sent + more).contains(&samples), "{samples} samples, {sent} sent in {steps} steps");
}
