//! `lashloop doctor` on pseudo-terminals with different far ends.

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::thread;

use lashloop::doctor::diagnosis::Health;
use lashloop::doctor::{Examination, LineUnderTest, examine};
use lashloop_bench::device::twin::Twin;
use lashloop_bench::link::pty::Pty;
use lashloop_protocol::{DriveMessage, Message};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

use crate::examples;
use crate::support::{lashloop, text};

fn line(terminal: &Path) -> Examination {
    examine(&LineUnderTest { terminal, baud: 921_600, rounds: 100 })
}

/// A twin that serves until the test's process ends.
fn twin() -> PathBuf {
    let twin = Twin::open().unwrap();
    let path = twin.path().to_owned();
    thread::spawn(move || twin.serve());
    path
}

fn wrong(examination: &Examination) -> String {
    let wrong = examination.diagnoses.iter().filter(|diagnosis| diagnosis.health == Health::Wrong);
    wrong.map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_twin_is_healthy_and_what_a_pty_has_not_does_not_apply() {
    let examination = line(&twin());
    assert!(examination.is_healthy(), "{:#?}", examination.diagnoses);
    let not_applicable =
        examination.diagnoses.iter().filter(|diagnosis| diagnosis.health == Health::NotApplicable);
    let about: Vec<_> = not_applicable.map(|diagnosis| diagnosis.subject).collect();
    assert_eq!(about, ["DTR", "latency timer", "speed"]);
}

#[test]
fn the_command_prints_times_that_took_time() {
    let output = lashloop(&["doctor", twin().to_str().unwrap()], &[]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stdout));
    let line = text(&output.stdout).lines().find(|line| line.contains("round trip")).unwrap();
    assert!(line.contains("1000 samples answered"), "{line}");
    let times: Vec<f64> =
        line.split(' ').filter_map(|word| word.parse().ok()).filter(|us| *us != 1000.0).collect();
    let [p50, p99, max] = times[..] else { panic!("{line}") };
    assert!(1.0 < p50 && p50 <= p99 && p99 <= max, "{line}");
}

#[test]
fn a_terminal_that_is_held_is_told_with_its_holder() {
    let path = twin();
    let _holder = Pty::open(&path).unwrap();
    let examination = line(&path);
    assert!(!examination.reached);
    let said = wrong(&examination);
    assert!(said.contains("another program holds it"), "{said}");
    assert!(said.contains(&format!("(process {})", std::process::id())), "{said}");
}

#[test]
fn a_silent_far_end_is_told() {
    let twin = Twin::open().unwrap();
    let examination = line(twin.path());
    assert!(!examination.reached);
    let said = wrong(&examination);
    assert!(said.contains("silent for 2.5 s after Hello") && said.contains("baud rate"), "{said}");
}

#[test]
fn a_drive_of_another_protocol_version_is_told_with_the_remedy() {
    let far_end = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&far_end).unwrap();
    unlockpt(&far_end).unwrap();
    let path = PathBuf::from(ptsname(&far_end, []).unwrap().into_string().unwrap());
    // Open in two places, or the line hangs up before the doctor has come.
    let _near_end = File::options().read(true).write(true).open(&path).unwrap();
    thread::spawn(move || {
        let Some(DriveMessage::Identity(mut identity)) = examples::from_drive().into_iter().next() else {
            unreachable!("the first message of a drive is its identity");
        };
        identity.protocol_version = 2;
        let mut far_end = File::from(far_end);
        while far_end.read(&mut [0; 64]).is_ok() {
            far_end.write_all(&DriveMessage::from(identity).frame()).unwrap();
        }
    });
    let said = wrong(&line(&path));
    assert!(said.contains("speaks protocol version 2, this bench speaks version 1: flash"), "{said}");
}

#[test]
fn a_terminal_that_is_not_there_is_told() {
    let output = lashloop(&["doctor", "/dev/no-such-terminal"], &[]);
    assert_eq!(output.status.code(), Some(4));
    assert!(text(&output.stdout).starts_with("WRONG  open"), "{}", text(&output.stdout));
}
