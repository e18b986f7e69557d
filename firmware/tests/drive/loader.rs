//! The request for the boot loader.

use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::actuator::StageCommand;
use lashloop_firmware::drive::{Drive, ManualClock};
use lashloop_protocol::enums::{Capabilities, Outcome, State};
use lashloop_protocol::message::{Arm, EnterLoader, Start};
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use crate::host::{HELLO, SESSION};
use crate::line::{Line, messages};
use crate::pin_host::HARDWARE;

/// A drive in `Idle`, at time 0.
fn idle(drive: Drive<Laws>) -> (Drive<Laws>, ManualClock) {
    let (mut drive, clock) = (drive, ManualClock::default());
    let _ = send(&mut drive, &clock, HELLO);
    (drive, clock)
}

fn send(drive: &mut Drive<Laws>, clock: &ManualClock, message: impl Into<HostMessage>) -> Vec<DriveMessage> {
    let frame = message.into().frame();
    assert_eq!(drive.receive(&frame, clock), frame.len());
    messages(Line::default().take(drive))
}

fn outcome(messages: &[DriveMessage]) -> (Outcome, State) {
    match messages {
        [DriveMessage::CommandResult(it)] => (it.outcome, it.state),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_drive_without_a_loader_refuses() {
    let (mut drive, clock) = idle(Drive::new("test"));
    for session in [SESSION, SESSION ^ 1] {
        let answer = send(&mut drive, &clock, EnterLoader { session });
        assert_eq!(outcome(&answer), (Outcome::WrongState, State::Idle));
    }
    assert!(!drive.enters_loader(Duration::from_secs(60)));
}

#[test]
fn another_session_and_other_states_are_refused() {
    let (mut drive, clock) = idle(Drive::new("test").with_loader());
    let request = |session| EnterLoader { session };
    let answer = send(&mut drive, &clock, request(SESSION ^ 1));
    assert_eq!(outcome(&answer), (Outcome::WrongSession, State::Idle));
    let _ = send(&mut drive, &clock, Arm { session: SESSION });
    let answer = send(&mut drive, &clock, request(SESSION));
    assert_eq!(outcome(&answer), (Outcome::WrongState, State::Armed));
    let _ = send(&mut drive, &clock, Start { session: SESSION });
    let answer = send(&mut drive, &clock, request(SESSION));
    assert_eq!(outcome(&answer), (Outcome::WrongState, State::Running));
    let mut boot = Drive::new("test").with_loader();
    let answer = send(&mut boot, &clock, request(SESSION));
    assert_eq!(outcome(&answer), (Outcome::WrongSession, State::Boot));
    for drive in [drive, boot] {
        assert!(!drive.enters_loader(Duration::from_secs(60)));
    }
}

#[test]
fn the_drive_leaves_once_its_answer_has_left() {
    let (mut drive, clock) = idle(Drive::new("test").with_loader());
    let answer = send(&mut drive, &clock, EnterLoader { session: SESSION });
    assert_eq!(outcome(&answer), (Outcome::Accepted, State::Idle));
    let after = Duration::from_millis;
    assert_eq!(
        [0, 9, 19, 20, 100].map(|ms| drive.enters_loader(after(ms))),
        [false, false, false, true, true]
    );
    assert_eq!(send(&mut drive, &clock, Arm { session: SESSION }), []);
    assert_eq!(drive.state(), State::Idle);
}

#[test]
fn the_power_stage_is_off_on_the_way() {
    let (mut drive, clock) = idle(Drive::with_pins("test", HARDWARE).with_loader());
    let _ = send(&mut drive, &clock, EnterLoader { session: SESSION });
    assert_eq!(drive.stage_command(), StageCommand::Off);
}

#[test]
fn the_identity_says_what_the_drive_has() {
    let any = Capabilities::DEVICE_TIME | Capabilities::CAPTURE;
    let cases = [
        (Drive::new("test"), any),
        (Drive::new("test").with_loader(), any | Capabilities::LOADER),
        (Drive::with_pins("test", HARDWARE), any | Capabilities::BENCH_MODE),
        (
            Drive::with_pins("test", HARDWARE).with_loader(),
            any | Capabilities::BENCH_MODE | Capabilities::LOADER,
        ),
    ];
    for (mut drive, want) in cases {
        match send(&mut drive, &ManualClock::default(), HELLO)[..] {
            [DriveMessage::Identity(it)] => assert_eq!(it.capabilities, want),
            ref other => panic!("{other:?}"),
        }
    }
}
