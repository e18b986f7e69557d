//! `lashloop doctor` on pseudo-terminals with different far ends.

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::device::twin::Twin;
use lashloop_bench::supervisor::Supervisor;
use lashloop_hardware::doctor::finding::Health;
use lashloop_hardware::doctor::{Examination, examine};
use lashloop_link::pty::Pty;
use lashloop_link::terminal::Terminal;
use lashloop_protocol::{DriveMessage, Message};

use crate::examples;
use crate::support::{lashloop, text};

fn examination(device: &str) -> Examination {
    let device: DeviceChoice = device.parse().expect("a device");
    let supervisor = Supervisor::without_signals(None).expect("a thread");
    examine(&device, 921_600, 100, &supervisor, |_| ())
}

fn name(path: &Path) -> String {
    path.to_str().expect("a path of ASCII").to_owned()
}

/// A twin that serves until the test's process ends.
fn twin() -> String {
    let twin = Twin::open().unwrap();
    let path = name(&twin.terminal.path);
    thread::spawn(move || twin.serve());
    path
}

fn wrong(examination: &Examination) -> String {
    let wrong = examination.findings.iter().filter(|finding| finding.health == Health::Wrong);
    wrong.map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn twin_is_healthy_and_serial_properties_do_not_apply() {
    let examination = examination(&twin());
    assert!(examination.is_healthy(), "{:#?}", examination.findings);
    let not_applicable =
        examination.findings.iter().filter(|finding| finding.health == Health::NotApplicable);
    let about: Vec<_> = not_applicable.map(|finding| finding.subject).collect();
    assert_eq!(about, ["DTR", "latency timer", "speed"]);
}

#[test]
fn command_prints_plausible_times() {
    let output = lashloop(&["doctor", &twin()], &[]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stdout));
    let line = text(&output.stdout).lines().find(|line| line.contains("round trip")).unwrap();
    assert!(line.contains("1000 samples answered"), "{line}");
    let times: Vec<f64> =
        line.split(' ').filter_map(|word| word.parse().ok()).filter(|us| *us != 1000.0).collect();
    let [p50, p99, max] = times[..] else { panic!("{line}") };
    assert!(1.0 < p50 && p50 <= p99 && p99 <= max, "{line}");
}

#[test]
fn held_terminal_is_reported_with_its_holder() {
    let path = twin();
    let _holder = Pty::open(path.as_ref()).unwrap();
    let examination = examination(&path);
    assert!(!examination.reached);
    let report = wrong(&examination);
    assert!(report.contains("another program holds it"), "{report}");
    assert!(report.contains(&format!("(process {})", std::process::id())), "{report}");
}

#[test]
fn silent_far_end_is_reported() {
    let twin = Twin::open().unwrap();
    let examination = examination(&name(&twin.terminal.path));
    assert!(!examination.reached);
    let report = wrong(&examination);
    assert!(report.contains("silent for 2.5 s after Hello") && report.contains("baud rate"), "{report}");
}

#[test]
fn findings_are_reported_while_the_examination_goes_on() {
    let twin = Twin::open().unwrap();
    let device: DeviceChoice = name(&twin.terminal.path).parse().expect("a device");
    let supervisor = Supervisor::without_signals(None).expect("a thread");
    let mut reported = Vec::new();
    examine(&device, 921_600, 100, &supervisor, |finding| reported.push((finding.subject, Instant::now())));
    let [(first, opened), .., (last, silent)] = reported[..] else { panic!("{reported:?}") };
    assert_eq!((first, last), ("open", "handshake"));
    assert!(silent - opened > Duration::from_secs(2), "{:?} from open to silence", silent - opened);
}

#[test]
fn other_protocol_version_is_reported_with_the_remedy() {
    let terminal = Terminal::open().unwrap();
    let far_end = terminal.far_end.try_clone().unwrap();
    thread::spawn(move || {
        let Some(DriveMessage::Identity(mut identity)) = examples::from_drive().into_iter().next() else {
            unreachable!("the first message of a drive is its identity");
        };
        identity.protocol_version = 2;
        let mut far_end = File::from(far_end);
        let identity = DriveMessage::from(identity).frame();
        // Until the bench closes the line.
        while far_end.read(&mut [0; 64]).and_then(|_| far_end.write_all(&identity)).is_ok() {}
    });
    let report = wrong(&examination(&name(&terminal.path)));
    assert!(report.contains("has protocol version 2, this bench has version 1: flash"), "{report}");
}

#[test]
fn missing_terminal_is_reported() {
    let output = lashloop(&["doctor", "/dev/no-such-terminal"], &[]);
    assert_eq!(output.status.code(), Some(4));
    assert!(text(&output.stdout).starts_with("WRONG  open"), "{}", text(&output.stdout));
}

#[test]
fn a_drive_without_a_terminal_is_examined_as_well() {
    let examination = examination("inproc");
    assert!(examination.is_healthy(), "{:#?}", examination.findings);
    let subjects: Vec<_> = examination.findings.iter().map(|finding| finding.subject).collect();
    let all = ["open", "DTR", "latency timer", "drain", "handshake", "round trip", "speed"];
    assert_eq!(subjects, all);
}

#[test]
fn a_command_that_is_no_drive_is_diagnosed() {
    let report = wrong(&examination("exec:sh -c 'echo usage: drive PORT; exec sleep 100'"));
    assert!(report.contains("text, \"usage: drive PORT\""), "{report}");
}
