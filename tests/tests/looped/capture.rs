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
const TOLERANT: [&str; 8] = [
    "--set",
    "allow.late=1000000",
    "--set",
    "allow.lost=1000000",
    "--set",
    "controller.parameters.watchdog_us=30000000",
    "--set",
    "link.silence_limit_ms=30000",
];

fn arguments<'a>(scenario: &'a str, duration: &'a str, file: &'a str) -> Vec<&'a str> {
    let mut arguments = vec!["run", scenario, "--clock", "real-time", "--set", duration, "--capture", file];
    arguments.extend(TOLERANT);
    arguments
}

/// Runs with a busy machine's drive that stood still for 1000 periods end early; one of these has to be whole.
const ATTEMPTS: usize = 5;

#[test]
fn a_bench_killed_in_real_time_leaves_whole_packets() {
    let records = Records::new();
    let file = records.path("line.pcapng");
    let is_killed = |_| {
        let _ = fs::remove_file(&file);
        let name = file.to_str().expect("a path in UTF-8");
        let mut bench = Running::start(arguments(&RUNS[1].scenario(), "run.duration_s=1000", name));
        wait::until("packets in the file", || {
            let is_written = fs::metadata(&file).is_ok_and(|file| file.len() > 100_000);
            (is_written || bench.has_ended()).then_some(())
        });
        if !bench.has_ended() {
            bench.signal(Signal::KILL);
        }
        let ended = bench.wait();
        println!("{ended:?}");
        ended.code.is_none()
    };
    assert!((0..ATTEMPTS).any(is_killed), "every bench has ended by itself");
    let bytes = fs::read(&file).expect("the capture");
    let packets: Vec<_> = reader::packets(&bytes).map(|packet| packet.expect("a whole packet")).collect();
    let back = packets.iter().filter(|packet| packet.direction == Some(Direction::DriveToHost)).count();
    assert!(packets.len() > 1_000 && back > 400, "{} packets, {back} from the drive", packets.len());
}

#[test]
fn a_real_time_capture_has_every_sample_sent() {
    let (scenario, steps) = (RUNS[1].scenario(), 1_000);
    let run = |_| {
        let records = Records::new();
        let (file, out) = (records.path("line.pcapng"), records.out());
        let file = file.to_str().expect("a path in UTF-8");
        let mut arguments = arguments(&scenario, "run.duration_s=1", file);
        arguments.extend(["--out", &out]);
        // One second is too short for the expectation of the scenario.
        let ended = program::run(arguments);
        println!("{ended:?}");
        let bytes = fs::read(file).expect("the capture");
        let summary = records.summary();
        (summary["end"] == "complete").then_some((ended.with_code(1), bytes, summary))
    };
    let (_, bytes, summary) = (0..ATTEMPTS).find_map(run).expect("a complete run");
    let samples = reader::packets(&bytes)
        .map(|packet| packet.expect("a whole packet"))
        .filter(|packet| packet.direction == Some(Direction::HostToDrive))
        .filter(|packet| packet.bytes.len() == EncoderSample::LAYOUT.frame_len())
        .count() as u64;
    let missed = summary["timing"]["missed"].as_u64().expect("a count");
    assert_eq!((summary["steps"].as_u64(), samples), (Some(steps), steps - missed));
}
