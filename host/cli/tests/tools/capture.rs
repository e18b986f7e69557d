//! A run with `--capture`, read back by a parser that is not ours.

use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use lashloop_decode::capture::reader;
use lashloop_decode::message::AnyMessage;
use lashloop_protocol::layout::Direction;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message};

use crate::diff::Runs;
use crate::support::{LASHLOOP, STEPS, lashloop, root, short_run, text};

#[test]
fn a_capture_holds_the_whole_conversation_frame_by_frame() {
    let run = short_run();
    let bytes = fs::read(&run.capture).unwrap();
    let packets: Vec<_> = reader::packets(&bytes).map(Result::unwrap).collect();
    assert_eq!(packets[0].bytes, [0], "the line is cleared first");
    let mut next_sample = 0;
    let mut torques_nm: Vec<f64> = Vec::new();
    let mut running = false;
    for packet in &packets[1..] {
        let mut rest = &packet.bytes[..];
        let message = Decoder::new().next::<AnyMessage>(&mut rest).unwrap().unwrap().message;
        assert!(rest.is_empty(), "one frame a packet, its delimiter last");
        assert_eq!(packet.direction, Some(message.layout().direction), "{message:?}");
        match message {
            AnyMessage::Host(HostMessage::Start(_)) => running = true,
            AnyMessage::Host(HostMessage::EncoderSample(sample)) if running => {
                assert_eq!(sample.sequence, next_sample);
                next_sample += 1;
            }
            AnyMessage::Drive(DriveMessage::TorqueAnswer(answer)) => torques_nm.push(answer.torque_nm.into()),
            _ => {}
        }
    }
    assert_eq!(next_sample as usize, STEPS);
    assert_eq!(torques_nm, run.torques_nm, "the torques of the trace, bit for bit");
    assert!(packets.is_sorted_by_key(|packet| packet.time_ns), "time never goes back");
    let now_ns = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos() as u64;
    let age = Duration::from_nanos(now_ns - packets.last().unwrap().time_ns);
    assert!(age < Duration::from_secs(600), "the calendar is that of this machine: {age:?}");
}

#[test]
fn a_run_that_is_killed_leaves_whole_packets_but_for_the_last() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("line.pcapng");
    let scenario = root().join("scenarios/smooth-after.toml");
    let mut command = Command::new(LASHLOOP);
    command.arg("run").arg(scenario).args([
        "--device",
        "inproc",
        "--set",
        "run.duration_s=4000",
        "--capture",
    ]);
    let mut child = command.arg(&path).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(30);
    while fs::metadata(&path).map_or(0, |file| file.len()) < 200_000 {
        assert!(
            Instant::now() < deadline && child.try_wait().unwrap().is_none(),
            "the capture does not grow"
        );
        std::thread::yield_now();
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let bytes = fs::read(&path).unwrap();
    let mut found: Vec<_> = reader::packets(&bytes).collect();
    // A kill during a write may truncate the last packet, which the reader reports.
    if found.last().is_some_and(Result::is_err) {
        found.pop();
    }
    let packets: Vec<_> = found.into_iter().map(|packet| packet.expect("whole")).collect();
    assert!(packets.len() > 1000, "{}", packets.len());
    assert!(packets.iter().any(|packet| packet.direction == Some(Direction::DriveToHost)));
}

#[test]
fn a_capture_that_can_t_be_written_ends_the_run_by_name() {
    let scenario = root().join("scenarios/smooth-after.toml");
    let ended =
        lashloop(&["run", scenario.to_str().unwrap(), "--device", "inproc", "--capture", "/dev/full"], &[]);
    assert_eq!(ended.status.code(), Some(2));
    let report = text(&ended.stderr);
    assert!(report.contains("/dev/full") && report.contains("can't be written"), "{report}");
}

#[test]
fn a_capture_or_an_fmu_replaces_neither_its_scenario_nor_a_record() {
    let (folder, runs) = (tempfile::tempdir().unwrap(), Runs::new());
    let scenario = folder.path().join("a.toml");
    fs::copy(root().join("scenarios/smooth-after.toml"), &scenario).unwrap();
    let record = runs.run("a", &[]).join("run.mcap");
    let before = [&scenario, &record].map(|path| fs::read(path).unwrap());
    let name = scenario.to_str().unwrap();
    for words in [
        ["run", name, "--device", "inproc", "--capture", name],
        ["run", name, "--device", "inproc", "--capture", record.to_str().unwrap()],
        ["fmu", "export", name, "--of=plant", "--out", name],
    ] {
        let ended = lashloop(&words, &[]);
        assert_eq!(ended.status.code(), Some(2), "{words:?}: {}", text(&ended.stderr));
    }
    assert!([&scenario, &record].map(|path| fs::read(path).unwrap()) == before);
}
