//! The rules of `docs/protocol.md` that oblige the host, on a link that records what the host sends.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use lashloop_bench::device::session_number;
use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_link::in_process::InProcess;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::enums::Outcome;
use lashloop_protocol::message::{EncoderSample, GetParameter};
use lashloop_protocol::{Counters, Decoder, DriveMessage, HostMessage};
use lashloop_session::handshake::shake_hands;
use lashloop_session::line::Line;
use lashloop_session::{Exchange, Session, SessionError, SetError};

use crate::alterations::{
    Alteration, Request, answers_reversed, cut, flagged, frame_of, longer, refusing, requests_reversed,
    reversed, unaltered, with_a_late_refusal, with_a_stale_identity, with_others,
};
use crate::host::rest;
use crate::markdown::{section, table};

const NUMBER: u32 = 77;

/// What passed the link, in order.
#[derive(Debug, Clone, PartialEq)]
enum Event {
    Sent(Vec<u8>),
    Received,
}

type Events = Arc<Mutex<Vec<Event>>>;

/// The drive in process, with a record of the events and alterations of requests and answers.
struct Recorded {
    drive: InProcess,
    events: Events,
    decoder: Decoder,
    requests: fn(Request) -> Request,
    answers: Alteration,
}

impl Link for Recorded {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut self.drive)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.events.lock().expect("the events").push(Event::Sent(bytes.to_vec()));
        match Decoder::new().next::<HostMessage>(&mut &*bytes) {
            Some(request) => self.drive.send(&frame_of((self.requests)(request.expect("a good frame")))),
            None => self.drive.send(bytes),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let mut received = [0; 1024];
        let count = self.drive.receive(&mut received, deadline)?;
        let (mut left, mut altered) = (&received[..count], Vec::new());
        while let Some(answer) = self.decoder.next::<DriveMessage>(&mut left) {
            self.events.lock().expect("the events").push(Event::Received);
            altered.extend((self.answers)(answer.expect("a good frame")));
        }
        buffer[..altered.len()].copy_from_slice(&altered);
        Ok(altered.len())
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.drive.discard_input()
    }
}

/// A session with the drive in process, and the events on its link.
fn open(answers: Alteration) -> (Session, Events) {
    open_altered(|request| request, answers)
}

fn open_altered(requests: fn(Request) -> Request, answers: Alteration) -> (Session, Events) {
    let (drive, decoder, events) = (InProcess::default(), Decoder::new(), Events::default());
    let link = Recorded { drive, events: Arc::clone(&events), decoder, requests, answers };
    (Session::open(Box::new(link), NUMBER).expect("a session"), events)
}

/// The messages that the host has sent.
fn sent(events: &Events) -> Vec<HostMessage> {
    sent_numbered(events).into_iter().map(|it| it.message).collect()
}

/// The messages that the host has sent, with their numbers.
fn sent_numbered(events: &Events) -> Vec<Request> {
    let events = events.lock().expect("the events");
    let messages = events.iter().filter_map(|event| match event {
        Event::Sent(bytes) => Decoder::new().next::<HostMessage>(&mut &bytes[..]),
        Event::Received => None,
    });
    messages.map(|message| message.expect("a good frame")).collect()
}

#[test]
fn the_first_byte_of_a_host_is_the_boundary_byte() {
    let (_, events) = open(unaltered);
    let first = events.lock().expect("the events")[0].clone();
    assert_eq!(first, Event::Sent(vec![0]));
}

#[test]
fn one_request_is_pending_at_a_time() {
    let (mut session, events) = open(unaltered);
    session.set("torque_limit_nm", 5.0).expect("a limit");
    session.start().expect("a start");
    for step in 0..3 {
        exchange(&mut session, step);
    }
    let mut is_pending = false;
    for event in events.lock().expect("the events").iter() {
        match event {
            Event::Sent(bytes) if bytes[..] == [0] => {}
            Event::Sent(bytes) => {
                assert!(!is_pending, "{bytes:02x?} before the answer to the request before it");
                is_pending = true;
            }
            Event::Received => is_pending = false,
        }
    }
}

/// The torque of a sample off its reference.
fn exchange(session: &mut Session, step: u32) -> u32 {
    let deadline = session.line.now() + Duration::from_millis(100);
    let sample = EncoderSample { reference_rad: 1.0, ..rest(0) };
    match session.exchange(step, &sample, deadline).expect("an exchange") {
        Exchange::Answered(answer) => answer.torque_nm.to_bits(),
        other => panic!("step {step}: {other:?}"),
    }
}

/// The torques of a run, and the counts of the host's receiver.
fn run_with(alteration: Alteration) -> (Vec<u32>, Counters) {
    let (mut session, _) = open(alteration);
    session.set("torque_limit_nm", 5.0).expect("a limit");
    session.start().expect("a start");
    let torques = (0..20).map(|step| exchange(&mut session, step)).collect();
    session.stop().expect("a stop");
    (torques, *session.line.decoder.counters())
}

#[test]
fn messages_in_between_change_nothing() {
    let ((quiet, _), (disturbed, counters)) = (run_with(unaltered), run_with(with_others));
    assert_eq!(quiet, disturbed);
    assert!(counters.refused > 0 && counters.unknown > 0, "{counters:?}");
}

#[test]
fn an_answer_with_another_number_is_dropped() {
    assert_eq!(run_with(unaltered).0, run_with(with_a_late_refusal).0);
}

#[test]
fn what_a_newer_drive_adds_or_leaves_out_changes_nothing() {
    let (torques, _) = run_with(unaltered);
    for alteration in [longer as Alteration, cut, flagged] {
        let (altered, counters) = run_with(alteration);
        assert_eq!((altered, counters.refused, counters.damaged()), (torques.clone(), 0, 0));
    }
}

#[test]
fn requests_are_numbered_from_1_to_255_in_turn() {
    let (mut session, events) = open(unaltered);
    for _ in 0..300 {
        session.line.request(&GetParameter { index: 0 }.into(), |_| Some(())).expect("an answer");
    }
    let numbers: Vec<_> = sent_numbered(&events).iter().map(|it| it.number).collect();
    let want: Vec<_> = (1..=u8::MAX).cycle().take(numbers.len()).collect();
    assert!(numbers.len() > 300);
    assert_eq!(numbers, want);
}

#[test]
fn a_retry_keeps_the_number_of_its_request() {
    let numbers_of = |request: fn(&mut Line) -> Result<(), SessionError>| -> Vec<u8> {
        let (mut line, events) = dead();
        drop(request(&mut line));
        drop(request(&mut line));
        sent_numbered(&events).iter().map(|it| it.number).collect()
    };
    let get = |line: &mut Line| line.request(&GetParameter { index: 0 }.into(), |_| None::<()>).map(drop);
    assert_eq!(numbers_of(get), [1, 1, 1, 1, 2, 2, 2, 2]);
    let hello = |line: &mut Line| shake_hands(line, NUMBER).map(drop);
    assert_eq!(numbers_of(hello), [[1; 25], [2; 25]].concat());
}

#[test]
fn a_handshake_follows_a_reset() {
    let (mut session, events) = open(unaltered);
    session.reset().expect("a reset");
    let sent = sent(&events);
    let [.., HostMessage::Reset(_), HostMessage::Hello(hello)] = sent[..] else { panic!("{sent:?}") };
    assert_ne!(hello.session, NUMBER, "frames of the run before can neither arm nor start");
}

#[test]
fn the_identity_of_another_session_is_not_accepted() {
    let (session, _) = open(with_a_stale_identity);
    assert_eq!((session.identity.session, session.laws.len()), (NUMBER, Laws::NAMES.len()));
    assert_ne!(session_number(), session_number(), "each host has a number of its own");
}

#[test]
fn names_and_not_indices_identify_parameters() {
    let first_torque = |requests, answers| {
        let (mut session, _) = open_altered(requests, answers);
        session.set("torque_limit_nm", 5.0).expect("a limit");
        session.start().expect("a start");
        (exchange(&mut session, 0), session.parameter("torque_limit_nm").expect("a limit").index)
    };
    let (torque, index) = first_torque(|request| request, unaltered);
    assert_eq!(f32::from_bits(torque), 5.0);
    assert_eq!(first_torque(requests_reversed, answers_reversed), (torque, reversed(index)));
}

#[test]
fn a_parameter_that_is_missing_or_refused_is_an_error() {
    let (mut session, _) = open(refusing);
    let refused = session.set("watchdog_us", 100_000.0);
    assert!(matches!(refused, Err(SetError::Refused { outcome: Outcome::OutOfRange, .. })), "{refused:?}");
    session.parameters.retain(|parameter| parameter.name != "watchdog_us");
    assert!(matches!(session.set("watchdog_us", 100_000.0), Err(SetError::Unknown(_))));
}

/// A link without a drive, in virtual time.
struct Dead {
    now: Instant,
    sent: Events,
}

impl Link for Dead {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.sent.lock().expect("the events").push(Event::Sent(bytes.to_vec()));
        Ok(())
    }

    fn receive(&mut self, _: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        self.now = self.now.max(deadline);
        Ok(0)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        Ok(())
    }

    fn now(&mut self) -> Instant {
        self.now
    }
}

/// A line without a drive, and what is sent on it.
fn dead() -> (Line, Events) {
    let events = Events::default();
    (Line::new(Box::new(Dead { now: Instant::now(), sent: Arc::clone(&events) })), events)
}

/// How long the host waits on a dead line, and how many messages it sends.
fn patience(request: impl FnOnce(&mut Line) -> Result<(), SessionError>) -> (Duration, usize) {
    let (mut line, events) = dead();
    let start = line.now();
    let error = request(&mut line).expect_err("nothing answers");
    assert!(matches!(error, SessionError::Silent { .. }), "{error}");
    (line.now() - start, sent(&events).len())
}

#[test]
fn the_time_limits_are_those_of_the_page() {
    let rows = table(section("## 13. Time limits"), "host waits for");
    let row = |waits_for: &str| &rows.iter().find(|row| row[0] == waits_for).expect("a row")[1];
    let handshake = patience(|line| shake_hands(line, NUMBER).map(drop));
    assert_eq!(row("Identity"), "2.5 s, with a Hello every 100 ms");
    assert_eq!(handshake, (Duration::from_millis(2500), 25));
    let request = patience(|line| line.request(&GetParameter { index: 0 }.into(), |_| None::<()>).map(drop));
    assert_eq!(row("the answer to any other request"), "2 s, with an attempt every 500 ms");
    assert_eq!(request, (Duration::from_secs(2), 4));
}
