//! Each trouble of a line, by a far end with a script.

mod patience;
mod peer;

use std::time::Duration;

use lashloop_protocol::enums::{FaultCode, LogLevel, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{
    DescribeLaw, FaultReport, Hello, LawDescription, LineReport, Log, Stop, TorqueAnswer,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, HostMessage, Message, crc, frame::DELIMITER};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;

use super::{Cause, CrcVariant, Diagnosis, FramingMistake};
use crate::SessionError;
use crate::line::Line;
use peer::{Peer, identity, sampled};

const SESSION: u32 = 0x0102_0304;
const ISO_HDLC: ::crc::Crc<u32> = ::crc::Crc::<u32>::new(&::crc::CRC_32_ISO_HDLC);
const MS: Duration = Duration::from_millis(1);
/// Length of the frame of `Hello`.
const HELLO: usize = 14;

/// The error of a session that does not open, after at most `limit` of the link's time.
fn failure(peer: Peer, limit: Duration) -> SessionError {
    let began = peer.now;
    let (mut line, ended) = open(peer);
    let held = line.now() - began;
    assert!(held <= limit, "{held:?}");
    ended.expect_err("no drive")
}

/// As `Session::open`, but the line stays.
fn open(peer: Peer) -> (Line, Result<(), SessionError>) {
    let mut line = Line::new(Box::new(peer));
    let ended = line.clear().and_then(|()| {
        let identity = crate::handshake::shake_hands(&mut line, SESSION)?;
        crate::Description::read(&mut line, &identity).map(drop)
    });
    (line, ended)
}

/// The diagnosis of a handshake, which takes 2.5 s from the first byte to the last.
fn diagnosis(peer: Peer) -> Diagnosis {
    match failure(peer, Duration::from_millis(2700)) {
        SessionError::Silent { diagnosis, .. } => *diagnosis,
        other => panic!("{other}"),
    }
}

/// A drive that sends bytes made from session and number of each `Hello`.
fn identifying(bytes_of: impl Fn(u32, u8) -> Vec<u8> + Send + 'static) -> Peer {
    Peer::answering(MS, move |request| match request.message {
        HostMessage::Hello(Hello { session, .. }) => Some(bytes_of(session, request.number)),
        _ => None,
    })
}

fn frame(number: u8, message: impl Into<DriveMessage>) -> Vec<u8> {
    message.into().numbered_frame(number).to_vec()
}

/// The body of an identity.
fn body(session: u32, number: u8) -> Vec<u8> {
    let mut frame = frame(number, identity(session));
    frame.pop();
    let unstuffed = lashloop_protocol::cobs::unstuff(&mut frame).expect("a frame");
    unstuffed[..unstuffed.len() - 4].to_vec()
}

/// The frame of an identity with its body and its CRC changed.
fn altered(
    session: u32,
    number: u8,
    alter: impl Fn(&mut Vec<u8>),
    crc_of: impl Fn(&[u8]) -> [u8; 4],
) -> Vec<u8> {
    let mut body = body(session, number);
    alter(&mut body);
    let mut stuffed = [&[0], &body[..], &crc_of(&body)].concat();
    lashloop_protocol::cobs::stuff(&mut stuffed);
    [&stuffed[..], &[DELIMITER]].concat()
}

/// The body of an identity and its CRC, without stuffing.
fn unstuffed(session: u32, number: u8) -> Vec<u8> {
    let body = body(session, number);
    [&body[..], &good_crc(&body), &[DELIMITER]].concat()
}

fn good_crc(body: &[u8]) -> [u8; 4] {
    crc::checksum(body).to_le_bytes()
}

fn boot_log() -> Vec<u8> {
    let text = Text::new("supply 24.1 V, encoder found");
    frame(0, Log { level: LogLevel::Info, text, device_time_us: None })
}

fn torque() -> Vec<u8> {
    let status = TorqueStatus { state: State::Idle, flags: TorqueFlags::empty() };
    frame(0, TorqueAnswer { sequence: 0, torque_nm: 0.0, status, compute_tenths_us: 0 })
}

fn noise() -> Peer {
    let mut random = Pcg64Mcg::new(1);
    Peer::streaming(10 * MS, move || {
        let mut piece = vec![0; 64];
        random.fill_bytes(&mut piece);
        piece
    })
}

fn cooked_echo() -> Peer {
    Peer::replying(|bytes| {
        let echo = bytes.iter().flat_map(|byte| match byte {
            0x00..0x20 => vec![b'^', byte ^ 0x40],
            0x7f => vec![b'^', b'?'],
            _ => vec![*byte],
        });
        vec![(MS, echo.collect())]
    })
}

fn trickle() -> Peer {
    Peer::replying(|bytes| {
        let bytes = if bytes.len() == HELLO { frame(1, identity(SESSION)) } else { Vec::new() };
        bytes.into_iter().map(|byte| (100 * MS, vec![byte])).collect()
    })
}

/// Every trouble of a handshake and the far end that causes it.
fn troubles() -> Vec<(&'static str, Peer)> {
    let other_crc = |crc_of: fn(&[u8]) -> [u8; 4]| {
        identifying(move |session, number| altered(session, number, |_| {}, crc_of))
    };
    let changed = |alter: fn(&mut Vec<u8>)| {
        identifying(move |session, number| altered(session, number, alter, good_crc))
    };
    let foreign_hello = || HostMessage::from(Hello::new(7)).numbered_frame(9).to_vec();
    let endless = |session, number| {
        let mut frame = frame(number, identity(session));
        frame.pop();
        frame
    };
    let padded = |session, number| [&[0xff; 40], &frame(number, identity(session))[..], &[0xff; 40]].concat();
    vec![
        ("nothing", Peer::replying(|_| Vec::new())),
        ("own frames", Peer::replying(|bytes| vec![(MS, bytes.to_vec())])),
        ("cooked echo", cooked_echo()),
        ("another host", Peer::streaming(100 * MS, foreign_hello)),
        ("answers without a request", Peer::streaming(20 * MS, torque)),
        ("state of 0", changed(|body| body[16] = 0)),
        ("board no text", changed(|body| body[17] = 0xff)),
        ("body too short", changed(|body| body.truncate(48))),
        ("kind unknown", changed(|body| body[0] = 0xc1)),
        ("constant session", identifying(|_, number| frame(number, identity(42)))),
        ("session big endian", identifying(|session, number| frame(number, identity(session.swap_bytes())))),
        ("number not repeated", identifying(|session, _| frame(0, identity(session)))),
        ("delimiter forgotten", identifying(endless)),
        ("no stuffing", identifying(unstuffed)),
        ("padding", identifying(padded)),
        ("padding alone", Peer::streaming(20 * MS, || vec![0xff; 8])),
        ("logs without end", Peer::streaming(MS / 10, boot_log)),
        ("logs alone", Peer::streaming(100 * MS, boot_log)),
        ("byte by byte", trickle()),
        ("CRC big endian", other_crc(|body| crc::checksum(body).to_be_bytes())),
        ("CRC of zlib", other_crc(|body| ISO_HDLC.checksum(body).to_le_bytes())),
        ("CRC not inverted", other_crc(|body| (!crc::checksum(body)).to_le_bytes())),
        ("console", Peer::replying(|_| vec![(MS, "\r\n\u{1b}[31mUbuntu 24.04 LTS, login: \u{202e}".into())])),
        ("modem", Peer::replying(|_| vec![(MS, b"\r\nERROR\r\n".to_vec())])),
        ("zero bytes", Peer::streaming(MS, || vec![0; 10])),
        ("frame without end", Peer::streaming(MS, || vec![0x55; 10])),
        ("far end 8 times slower", Peer::streaming(100 * MS, || sampled(&boot_log(), 8.0))),
        ("far end 3 times faster", Peer::streaming(30 * MS, || sampled(&boot_log(), 0.33))),
        ("noise", noise()),
    ]
}

fn cause_of(trouble: &str) -> Cause {
    let (_, peer) = troubles().into_iter().find(|(name, _)| *name == trouble).expect("a trouble");
    diagnosis(peer).cause
}

#[test]
fn each_trouble_has_its_sentence() {
    let table = troubles().into_iter().map(|(name, peer)| format!("{name}\n    {}\n", diagnosis(peer)));
    insta::assert_snapshot!(table.collect::<String>());
}

#[test]
fn the_bench_s_own_frames_are_a_loopback() {
    assert_eq!(cause_of("own frames"), Cause::Loopback);
    assert_eq!(cause_of("cooked echo"), Cause::CookedEcho);
    // The echo of a frame after a signal character, as a terminal with ISIG sends it.
    let end_of_echo = Peer::replying(|_| vec![(MS, b"^\\\xf3\xddAi%\xcf^@".to_vec())]);
    assert_eq!(diagnosis(end_of_echo).cause, Cause::CookedEcho);
}

#[test]
fn another_host_is_told_from_a_drive() {
    assert_eq!(cause_of("another host"), Cause::HostAtFarEnd { request: "Hello" });
    assert_eq!(cause_of("answers without a request"), Cause::SecondHost);
}

#[test]
fn a_refused_identity_is_named_with_field_and_value() {
    for (trouble, text) in [
        ("state of 0", "Identity with state 0, no value of State"),
        ("body too short", "Identity with a body of 48 bytes; it has at least 49"),
    ] {
        let Cause::Refused(refusal) = cause_of(trouble) else { panic!("{trouble}") };
        assert_eq!(refusal.to_string(), text);
    }
}

#[test]
fn an_identity_of_another_session_is_named_with_both() {
    assert_eq!(cause_of("constant session"), Cause::OtherSession { received: 42, sent: SESSION });
    let swapped = Cause::OtherSession { received: 0x0403_0201, sent: SESSION };
    assert_eq!(cause_of("session big endian"), swapped);
}

#[test]
fn a_usual_mistake_in_the_crc_is_named() {
    for (trouble, variant) in [
        ("CRC big endian", CrcVariant::MostSignificantFirst),
        ("CRC of zlib", CrcVariant::IsoHdlc),
        ("CRC not inverted", CrcVariant::WithoutFinalXor),
    ] {
        assert_eq!(cause_of(trouble), Cause::Crc(variant), "{trouble}");
    }
}

#[test]
fn bytes_without_frames_are_told_apart() {
    for (trouble, cause) in [
        ("zero bytes", Cause::ZeroBytes),
        ("frame without end", Cause::EndlessFrame),
        ("far end 8 times slower", Cause::LowerBaud),
        ("far end 3 times faster", Cause::NoFrames),
        ("noise", Cause::NoFrames),
        ("byte by byte", Cause::Trickle),
        ("logs without end", Cause::Flood),
        ("logs alone", Cause::Deaf),
        ("number not repeated", Cause::OtherNumber { received: 0, sent: 1 }),
        ("delimiter forgotten", Cause::Framing(FramingMistake::NoDelimiter)),
        ("no stuffing", Cause::Framing(FramingMistake::NoCobs)),
        ("padding", Cause::Framing(FramingMistake::Padding { byte: 0xff })),
        ("padding alone", Cause::NoFrames),
        ("modem", Cause::Text("ERROR".to_owned())),
        ("console", Cause::Text("\\u{1b}[31mUbuntu 24.04 LTS, login: \\u{202e}".to_owned())),
    ] {
        assert_eq!(cause_of(trouble), cause, "{trouble}");
    }
}

#[test]
fn a_trickle_is_named_after_its_first_bytes() {
    for pause_ms in [300, 600, 800] {
        let mut sent = false;
        let peer = Peer::replying(move |bytes| {
            let is_first = bytes.len() == HELLO && !std::mem::replace(&mut sent, true);
            let bytes = if is_first { frame(1, identity(SESSION)) } else { Vec::new() };
            bytes.into_iter().map(|byte| (pause_ms * MS, vec![byte])).collect()
        });
        assert_eq!(diagnosis(peer).cause, Cause::Trickle, "{pause_ms} ms");
    }
}

#[test]
fn an_echo_in_front_of_a_drive_does_no_harm() {
    let mut drive = identifying(|session, number| frame(number, identity(session)));
    let echoing = Peer::replying(move |bytes| {
        use lashloop_link::Link;
        drive.send(bytes).expect("a peer");
        let mut answer = [0; 64];
        let later = drive.now + MS;
        let count = drive.receive(&mut answer, later).expect("a peer");
        let pieces = [bytes.to_vec(), answer[..count].to_vec()];
        pieces.into_iter().filter(|piece| !piece.is_empty()).map(|piece| (MS, piece)).collect()
    });
    let error = failure(echoing, Duration::from_secs(5));
    let SessionError::Silent { waiting_for: "DescribeLaw", diagnosis, .. } = error else {
        panic!("{error}");
    };
    assert_eq!((diagnosis.cause, diagnosis.arrivals.own_frames), (Cause::Hang, 4));
}

/// The error of the first request after a handshake, whose answer is followed by these bytes and by nothing more.
fn after_the_identity(bytes_of: impl Fn(u8) -> Vec<u8> + Send + 'static) -> SessionError {
    let mut session = Some(());
    let peer = Peer::answering(MS, move |request| match request.message {
        HostMessage::Hello(Hello { session: number, .. }) => session
            .take()
            .map(|()| [frame(request.number, identity(number)), bytes_of(request.number)].concat()),
        _ => None,
    });
    failure(peer, Duration::from_secs(3))
}

#[test]
fn telemetry_behind_the_last_answer_is_no_answer() {
    let error = after_the_identity(|_| boot_log());
    let SessionError::Silent { ref diagnosis, .. } = error else { panic!("{error}") };
    assert_eq!((&diagnosis.cause, diagnosis.arrivals.good_count()), (&Cause::Hang, 1));
    assert!(error.to_string().starts_with("the drive was silent for 2.0 s after DescribeLaw"), "{error}");
}

fn fault(code: FaultCode, detail: u32) -> FaultReport {
    FaultReport { code, sequence: 0, value: 0.0, limit: 0.0, detail, device_time_us: None }
}

#[test]
fn a_fault_before_the_silence_is_its_cause() {
    let error = after_the_identity(|_| frame(0, fault(FaultCode::Panic, 77)));
    let SessionError::Silent { ref diagnosis, .. } = error else { panic!("{error}") };
    assert_eq!(diagnosis.cause, Cause::Halted { code: FaultCode::Panic, detail: 77 });
    assert!(error.to_string().contains("the firmware panicked at source line 77"), "{error}");
}

#[test]
fn a_frame_that_does_not_end_is_no_damage() {
    let error = after_the_identity(|number| {
        frame(number, LawDescription { index: 0, name: Text::new("pd") })[..9].to_vec()
    });
    let SessionError::Silent { diagnosis, .. } = error else { panic!("{error}") };
    assert_eq!(diagnosis.cause, Cause::Unfinished);
}

/// The cause of the silence after a request, from a drive that sends these bytes for it.
fn cause_after(request: impl Into<HostMessage>, bytes_of: impl Fn(u8) -> Vec<u8> + Send + 'static) -> Cause {
    let peer = Peer::answering(MS, move |request| match request.message {
        HostMessage::Hello(Hello { session, .. }) => Some(frame(request.number, identity(session))),
        _ => Some(bytes_of(request.number)),
    });
    let mut line = Line::new(Box::new(peer));
    crate::handshake::shake_hands(&mut line, SESSION).expect("an identity");
    let ended = line.request(&request.into(), |answer| match answer {
        DriveMessage::CommandResult(_) => Some(()),
        DriveMessage::LawDescription(it) if it.index == 0 => Some(()),
        _ => None,
    });
    match ended.err().expect("no answer") {
        SessionError::Silent { diagnosis, .. } => diagnosis.cause,
        other => panic!("{other}"),
    }
}

#[test]
fn an_answer_that_repeats_the_request_wrongly_is_named() {
    let law = |number, index| frame(number, LawDescription { index, name: Text::new("pd") });
    let cause = cause_after(DescribeLaw { index: 0 }, move |number| law(number, 1));
    assert!(matches!(cause, Cause::OtherIndex(other) if (other.received, other.sent) == (1, 0)), "{cause}");
    let other_number = Cause::OtherNumber { received: 1, sent: 2 };
    assert_eq!(cause_after(DescribeLaw { index: 0 }, move |_| law(1, 0)), other_number, "late");
    let report = LineReport { messages: 1, damaged: 0, refused: 0, overruns: 0, device_time_us: None };
    let part = Cause::PartAnswer { part: "LineReport" };
    assert_eq!(cause_after(Stop {}, move |number| frame(number, report)), part);
}
