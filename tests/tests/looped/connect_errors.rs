//! Drives that can't be used: each gives exit code 4 and a sentence with the remedy.

use std::time::{Duration, Instant};

use lashloop_protocol::DriveMessage;
use lashloop_protocol::message::Identity;
use tests::loss::run_in_progress;
use tests::paper::RUNS;
use tests::program::{self, Ended};
use tests::relay::{Action, Relay};
use tests::terminal;
use tests::twin::Twin;

fn run_on(device: &str) -> Ended {
    program::run(["run", &RUNS[1].scenario(), "--device", device]).with_code(4)
}

/// The sentence, with a placeholder for the terminal.
fn sentence(ended: &Ended, device: &str) -> String {
    ended.stderr.replace(device, "TERMINAL")
}

#[test]
fn a_drive_of_another_version_is_rejected_by_both_versions() {
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), |frame| match frame.from_drive() {
        Some(DriveMessage::Identity(identity)) => {
            frame.replaced(Identity { protocol_version: 9, ..identity })
        }
        _ => Action::Forward,
    });
    let ended = run_on(relay.device());
    insta::assert_snapshot!(sentence(&ended, relay.device()));
}

#[test]
fn a_silent_terminal_times_out_with_advice() {
    let terminal = terminal::open();
    let started = Instant::now();
    let ended = run_on(&terminal::device(&terminal));
    let took = ended.at - started;
    assert!(took <= Duration::from_secs(4), "took {took:?}");
    insta::assert_snapshot!(sentence(&ended, &terminal::device(&terminal)));
}

#[test]
fn a_missing_terminal_is_named() {
    let errors = ["/dev/pts/999999", "/dev/ttyNONE0"].map(|device| run_on(device).stderr);
    insta::assert_snapshot!(errors.concat());
}

#[test]
fn a_drive_in_use_is_rejected_and_its_run_continues() {
    let twin = Twin::start();
    let (first, records) = run_in_progress(&twin.device());
    let ended = run_on(&twin.device());
    insta::assert_snapshot!(sentence(&ended, &twin.device()));
    first.signal(rustix::process::Signal::INT);
    let _ = first.wait().with_code(3);
    let link = &records.summary()["link"];
    assert_eq!(
        (&link["lost"], &link["crc_errors"], &link["damaged_at_drive"]),
        (&0.into(), &0.into(), &0.into())
    );
}
