//! The rules of `docs/protocol.md` that oblige the host, on a link that records what the host sends.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use lashloop_bench::device::session_number;
use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_link::in_process::InProcess;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::enums::{LogLevel, Outcome, ParameterValue, State};
use lashloop_protocol::message::{
    ChoiceDescription, CommandResult, DescribeChoice, DescribeParameter, EncoderSample, GetParameter,
    Identity, Log, ParameterDescription, ParameterReport, SetParameter,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message, crc};
use lashloop_session::handshake::shake_hands;
use lashloop_session::line::Line;
use lashloop_session::{Exchange, Session, SessionError, SetError};

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

/// A change to each answer of the drive: the messages that arrive in its place.
type Alteration = fn(DriveMessage) -> Vec<u8>;

/// The drive in process, with a record of the events and alterations of requests and answers.
struct Recorded {
    drive: InProcess,
    events: Events,
    decoder: Decoder,
    requests: fn(HostMessage) -> HostMessage,
    answers: Alteration,
}

impl Link for Recorded {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut self.drive)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.events.lock().expect("the events").push(Event::Sent(bytes.to_vec()));
        match Decoder::new().next::<HostMessage>(&mut &*bytes) {
            Some(request) => self.drive.send(&(self.requests)(request.expect("a good frame")).frame()),
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

fn unaltered(answer: DriveMessage) -> Vec<u8> {
    answer.frame().to_vec()
}

/// A session with the drive in process, and the events on its link.
fn open(answers: Alteration) -> (Session, Events) {
    open_altered(|request| request, answers)
}

fn open_altered(requests: fn(HostMessage) -> HostMessage, answers: Alteration) -> (Session, Events) {
    let (drive, decoder, events) = (InProcess::default(), Decoder::new(), Events::default());
    let link = Recorded { drive, events: Arc::clone(&events), decoder, requests, answers };
    (Session::open(Box::new(link), NUMBER).expect("a session"), events)
}

/// The messages that the host has sent.
fn sent(events: &Events) -> Vec<HostMessage> {
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

/// A frame around a body, by the three steps of the page.
fn frame_around(body: &[u8]) -> Vec<u8> {
    let with_crc = [body, &crc::checksum(body).to_le_bytes()].concat();
    let pieces: Vec<_> = with_crc.split(|byte| *byte == 0).collect();
    let stuffed = pieces.iter().flat_map(|piece| [&[piece.len() as u8 + 1], *piece].concat());
    stuffed.chain([0]).collect()
}

/// Messages that no request of these tests has asked for, then the answer.
fn with_others(answer: DriveMessage) -> Vec<u8> {
    let (outcome, state, index) = (Outcome::WrongState, State::Faulted, 200);
    let others: [DriveMessage; 3] = [
        Log { level: LogLevel::Error, text: Text::new("stop the run now") }.into(),
        ParameterReport { index, outcome, value: ParameterValue::U32(7), state }.into(),
        CommandResult { request: 0x70, outcome, state }.into(),
    ];
    let unknown = frame_around(&[0xfe, 1, 2, 3]);
    others.iter().flat_map(|other| other.frame().to_vec()).chain(unknown).chain(unaltered(answer)).collect()
}

#[test]
fn messages_in_between_change_nothing() {
    let torques = |alteration| {
        let (mut session, _) = open(alteration);
        session.set("torque_limit_nm", 5.0).expect("a limit");
        session.start().expect("a start");
        let torques: Vec<_> = (0..20).map(|step| exchange(&mut session, step)).collect();
        session.stop().expect("a stop");
        (torques, session.line.decoder.counters().refused > 0)
    };
    let ((quiet, quiet_refused), (disturbed, disturbed_refused)) = (torques(unaltered), torques(with_others));
    assert_eq!(quiet, disturbed);
    assert_eq!([quiet_refused, disturbed_refused], [false, true]);
}

#[test]
fn a_handshake_follows_a_reset() {
    let (mut session, events) = open(unaltered);
    session.reset().expect("a reset");
    let sent = sent(&events);
    let [.., HostMessage::Reset(_), HostMessage::Hello(hello)] = sent[..] else { panic!("{sent:?}") };
    assert_ne!(hello.session, NUMBER, "frames of the run before can neither arm nor start");
}

/// An identity of another session, in another state, before each identity.
fn with_a_stale_identity(answer: DriveMessage) -> Vec<u8> {
    let stale = match answer {
        DriveMessage::Identity(it) => {
            let session = it.session ^ 1;
            let stale = DriveMessage::from(Identity { session, law_count: 9, ..it });
            stale.frame().to_vec()
        }
        _ => Vec::new(),
    };
    [stale, unaltered(answer)].concat()
}

#[test]
fn the_identity_of_another_session_is_not_accepted() {
    let (session, _) = open(with_a_stale_identity);
    assert_eq!((session.identity.session, session.laws.len()), (NUMBER, Laws::NAMES.len()));
    assert_ne!(session_number(), session_number(), "each host has a number of its own");
}

/// The index of another parameter: all of them in reverse order.
fn reversed(index: u8) -> u8 {
    (Laws::PARAMETERS.len() as u8).wrapping_sub(1 + index)
}

fn answers_reversed(answer: DriveMessage) -> Vec<u8> {
    unaltered(match answer {
        DriveMessage::ParameterDescription(it) => {
            ParameterDescription { index: reversed(it.index), ..it }.into()
        }
        DriveMessage::ParameterReport(it) => ParameterReport { index: reversed(it.index), ..it }.into(),
        DriveMessage::ChoiceDescription(it) => {
            ChoiceDescription { parameter: reversed(it.parameter), ..it }.into()
        }
        other => other,
    })
}

fn requests_reversed(request: HostMessage) -> HostMessage {
    match request {
        HostMessage::DescribeParameter(it) => DescribeParameter { index: reversed(it.index) }.into(),
        HostMessage::GetParameter(it) => GetParameter { index: reversed(it.index) }.into(),
        HostMessage::SetParameter(it) => SetParameter { index: reversed(it.index), ..it }.into(),
        HostMessage::DescribeChoice(it) => DescribeChoice { parameter: reversed(it.parameter), ..it }.into(),
        other => other,
    }
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

/// A drive that refuses every value.
fn refusing(answer: DriveMessage) -> Vec<u8> {
    match answer {
        DriveMessage::ParameterReport(it) => {
            DriveMessage::from(ParameterReport { outcome: Outcome::OutOfRange, ..it }).frame().to_vec()
        }
        other => unaltered(other),
    }
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

/// How long the host waits on a dead line, and how many messages it sends.
fn patience(request: impl FnOnce(&mut Line) -> Result<(), SessionError>) -> (Duration, usize) {
    let (start, events) = (Instant::now(), Events::default());
    let mut line = Line::new(Box::new(Dead { now: start, sent: Arc::clone(&events) }));
    let error = request(&mut line).expect_err("nothing answers");
    assert!(matches!(error, SessionError::Silent { .. }), "{error}");
    (line.now() - start, sent(&events).len())
}

#[test]
fn the_time_limits_are_those_of_the_page() {
    let rows = table(section("## 13. Time limits"), "who");
    let row = |waits_for: &str| &rows.iter().find(|row| row[1] == waits_for).expect("a row")[2];
    let handshake = patience(|line| shake_hands(line, NUMBER).map(drop));
    assert_eq!(row("Identity"), "2.5 s, with a Hello every 100 ms");
    assert_eq!(handshake, (Duration::from_millis(2500), 25));
    let request = patience(|line| line.request(&GetParameter { index: 0 }.into(), |_| None::<()>).map(drop));
    assert_eq!(row("the answer to any other request"), "2 s, with an attempt every 500 ms");
    assert_eq!(request, (Duration::from_secs(2), 4));
}
