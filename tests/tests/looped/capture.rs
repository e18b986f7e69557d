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

/// A busy machine causes late and lost answers; these limits keep them out of the verdict. A drive may stand still for 5 s: so
/// long are the 1000 periods after which no drive takes a sample. The reference keeps the mechanics at rest: a torque that is held
/// for long would accelerate the motor beyond its speed limit.
const TOLERANT: [&str; 12] = [
    "--set",
    "allow.late=1000000",
    "--set",
    "allow.lost=1000000",
    "--set",
    "controller.parameters.watchdog_us=10000000",
    "--set",
    "link.silence_limit_ms=5000",
    "--set",
    "run.control_period_us=5000",
    "--set",
    "reference={ profile = \"constant\", position_rad = 0.0 }",
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
    let mut bench = Running::start(arguments(
        &RUNS[1].scenario(),
        "run.duration_s=1000",
        file.to_str().expect("a path in UTF-8"),
    ));
    wait::until("packets in the file", || {
        let is_written = fs::metadata(&file).is_ok_and(|file| file.len() > 100_000);
        (is_written || bench.has_ended()).then_some(())
    });
    if bench.has_ended() {
        panic!("the bench has ended by itself: {:?}", bench.wait());
    }
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
    let mut arguments = arguments(&scenario, "run.duration_s=2", file.to_str().expect("a path in UTF-8"));
    arguments.extend(["--out", &out]);
    // Two seconds are too short for the expectation of the scenario.
    let _ = program::run(arguments).with_code(1);
    let bytes = fs::read(&file).expect("the capture");
    let samples = reader::packets(&bytes)
        .map(|packet| packet.expect("a whole packet"))
        .filter(|packet| packet.direction == Some(Direction::HostToDrive))
        .filter(|packet| packet.bytes.len() == EncoderSample::LAYOUT.frame_len())
        .count() as u64;
    let summary = records.summary();
    let missed = summary["timing"]["missed"].as_u64().expect("a count");
    assert_eq!((&summary["steps"], &summary["end"]), (&400.into(), &"complete".into()));
    assert_eq!(samples, 400 - missed);
}
