//! Hosts of another minor version, numbers of requests, and device time.

use std::time::Duration;

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::limits::MAX_BODY;
use lashloop_protocol::message::{
    Arm, CommandResult, EmergencyStop, Hello, LineReport, Start, Stop, Subscribe,
};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, Frame, HostMessage, Message, Numbered};

use crate::host::{HELLO, Host, SESSION, sample, torque};
use crate::line::device_time;

/// A kind that no host of this version sends, and one of those that get no answer.
const NEWER_KIND: u8 = 0x2a;
const NEWER_PERIODIC_KIND: u8 = 0x1e;

/// A host in each state.
fn in_every_state() -> [(Host, State); 5] {
    let mut armed = Host::idle();
    armed.send(Arm { session: SESSION });
    let mut faulted = Host::idle();
    faulted.send(EmergencyStop {});
    [
        (Host::new(), State::Boot),
        (Host::idle(), State::Idle),
        (armed, State::Armed),
        (Host::running(&[]), State::Running),
        (faulted, State::Faulted),
    ]
}

/// The body of a message with this number, and then these bytes of a newer version.
fn longer<P: Payload>(message: &P, number: u8, more: &[u8]) -> Vec<u8> {
    let mut body = vec![0; message.body_len()];
    message.put(number, &mut body);
    [&body[..], more].concat()
}

#[test]
fn an_answer_repeats_the_number_of_its_request_whatever_it_is() {
    let mut host = Host::idle();
    for number in [200, 1, 1, 0, 255] {
        let frame = HostMessage::from(Stop {}).numbered_frame(number);
        let numbers: Vec<u8> = host.exchange(&frame).iter().map(|answer| answer.number).collect();
        assert_eq!(numbers, [number; 2], "LineReport and CommandResult");
    }
}

#[test]
fn the_result_of_a_refused_sample_has_the_number_0() {
    let mut host = Host::new();
    host.exchange(&HostMessage::from(Stop {}).numbered_frame(9));
    let answers = host.exchange(&Frame::of(&sample(0, 0, 0)));
    let [Numbered { number: 0, message: DriveMessage::CommandResult(it) }] = answers[..] else {
        panic!("{answers:?}")
    };
    assert_eq!(it.outcome, Outcome::WrongState);
}

#[test]
fn an_unknown_request_is_answered_in_every_state_and_changes_nothing() {
    for (mut host, state) in in_every_state() {
        let answers = host.exchange(&Frame::around(&[NEWER_KIND, 77, 1, 2, 3]));
        let want = CommandResult {
            request: NEWER_KIND,
            outcome: Outcome::UnknownRequest,
            state,
            detail: 0,
            device_time_us: Some(0),
        };
        assert_eq!(answers, [Numbered { number: 77, message: DriveMessage::from(want) }]);
        assert_eq!(host.drive.state(), state);
    }
}

#[test]
fn an_unknown_request_of_one_byte_has_the_number_0() {
    let answers = Host::idle().exchange(&Frame::around(&[NEWER_KIND]));
    assert!(
        matches!(answers[..], [Numbered { number: 0, message: DriveMessage::CommandResult(_) }]),
        "{answers:?}"
    );
}

#[test]
fn an_unknown_message_of_every_period_gets_no_answer() {
    for (mut host, state) in in_every_state() {
        assert_eq!(host.exchange(&Frame::around(&[NEWER_PERIODIC_KIND, 1, 2])), []);
        assert_eq!(host.drive.state(), state);
    }
}

#[test]
fn a_message_of_the_drive_is_refused_as_an_echo() {
    let mut host = Host::running(&[]);
    for kind in [0x00, 0x80, 0x85, 0xaa] {
        assert_eq!(host.exchange(&Frame::around(&[kind, 1, 2, 3, 4])), []);
    }
    let DriveMessage::LineReport(report) = host.send(Stop {})[0] else { panic!("a line report") };
    assert_eq!((report.messages, report.refused), (1, 4));
}

#[test]
fn an_unknown_request_counts_as_a_good_message_and_feeds_no_watchdog() {
    let mut host = Host::running(&[]);
    host.sample(0, 0, 0);
    for kind in [NEWER_KIND, NEWER_PERIODIC_KIND] {
        host.clock.advance(Duration::from_millis(9));
        host.exchange(&Frame::around(&[kind, 1]));
    }
    let device_time_us = Some(18_000);
    // The sample, both of them, and the stop.
    let want = LineReport { messages: 4, damaged: 0, refused: 0, overruns: 0, device_time_us };
    assert_eq!(host.send(Stop {})[0], DriveMessage::LineReport(want));

    let mut host = Host::running(&[]);
    host.clock.advance(Duration::from_millis(19));
    host.exchange(&Frame::around(&[NEWER_KIND, 1]));
    host.advance(Duration::from_millis(2));
    assert_eq!(host.drive.state(), State::Faulted);
}

#[test]
fn a_hello_with_further_fields_is_accepted() {
    let mut host = Host::new();
    let minor_version = HELLO.minor_version + 1;
    let body = longer(&Hello { minor_version, ..HELLO }, 3, &[0xaa; 9]);
    let answers = host.exchange(&Frame::around(&body));
    let [Numbered { number: 3, message: DriveMessage::Identity(identity) }] = answers[..] else {
        panic!("{answers:?}")
    };
    assert_eq!((identity.session, identity.state), (SESSION, State::Idle));
}

#[test]
fn a_request_and_a_sample_of_any_longer_body_are_taken() {
    let mut host = Host::idle();
    for body in [
        longer(&Subscribe { signals: 1, every: 1 }, 1, &[7]),
        longer(&Arm { session: SESSION }, 2, &[0; 4]),
        longer(&Start { session: SESSION }, 3, &[0xff; 2]),
    ] {
        let answers = host.send_bytes(&Frame::around(&body));
        assert!(
            matches!(answers[..], [DriveMessage::CommandResult(it)] if it.outcome == Outcome::Accepted),
            "{answers:?}"
        );
    }
    let mut body = longer(&sample(0, 1000, 1000), 0, &[]);
    body.resize(MAX_BODY, 0x55);
    let answers = host.send_bytes(&Frame::around(&body));
    assert_ne!(torque(&answers).torque_nm, 0.0);
    assert!(matches!(answers[1], DriveMessage::Telemetry(_)), "{answers:?}");
}

#[test]
fn a_body_that_is_too_short_is_refused() {
    let mut host = Host::running(&[]);
    let mut body = longer(&Stop {}, 1, &[]);
    body.pop();
    assert_eq!(host.exchange(&Frame::around(&body)), []);
    let mut body = longer(&HELLO, 2, &[]);
    body.pop();
    assert_eq!(host.exchange(&Frame::around(&body)), []);
    assert_eq!(host.drive.state(), State::Running);
    let DriveMessage::LineReport(report) = host.send(Stop {})[0] else { panic!("a line report") };
    assert_eq!(report.refused, 2);
}

#[test]
fn a_message_has_the_time_at_which_its_request_arrived() {
    let mut host = Host::idle();
    for advanced_us in [1, 999, 3_000_000] {
        let before = Duration::from_micros(advanced_us);
        host.clock.advance(before);
        let now = lashloop_firmware::drive::Clock::now(&host.clock).as_micros() as u32;
        for answer in host.send(Stop {}) {
            assert_eq!(device_time(&answer), Some(Some(now)));
        }
    }
}

/// [`Host`] requires it of all messages; here time jumps back between a tick and a request.
#[test]
fn device_time_does_not_run_backwards_behind_a_tick() {
    let mut host = Host::running(&[]);
    host.drive.tick(Duration::from_millis(21));
    let answers = host.send(Stop {});
    let times: Vec<_> = answers.iter().filter_map(device_time).collect();
    assert_eq!(times, [Some(21_000); 3], "{answers:?}");
}
