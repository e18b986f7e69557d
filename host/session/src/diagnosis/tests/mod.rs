//! Each trouble of a line, by a far end with a script.

mod peer;

use std::time::Duration;

use lashloop_protocol::enums::{LogLevel, ParameterFlags, ParameterValue, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{
    ChoiceDescription, Hello, Identity, LawDescription, Log, ParameterDescription, TorqueAnswer,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, HostMessage, Message, crc, frame::DELIMITER};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;

use super::{Cause, CrcVariant, Diagnosis};
use crate::line::Line;
use crate::{PATIENCE, SessionError};
use peer::{Peer, identity, sampled};

const SESSION: u32 = 0x0102_0304;
const ISO_HDLC: ::crc::Crc<u32> = ::crc::Crc::<u32>::new(&::crc::CRC_32_ISO_HDLC);
const MS: Duration = Duration::from_millis(1);

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

/// A drive whose frames are made from its identity.
fn identifying(frame_of: impl Fn(u32) -> Vec<u8> + Send + 'static) -> Peer {
    Peer::answering(MS, move |request| match request {
        HostMessage::Hello(Hello { session, .. }) => Some(frame_of(session)),
        _ => None,
    })
}

fn frame(message: impl Into<DriveMessage>) -> Vec<u8> {
    message.into().frame().to_vec()
}

/// The frame of an identity with its body and its CRC changed.
fn altered(session: u32, alter: impl Fn(&mut Vec<u8>), crc_of: impl Fn(&[u8]) -> [u8; 4]) -> Vec<u8> {
    let mut body = frame(identity(session));
    body.pop();
    let unstuffed = lashloop_protocol::cobs::unstuff(&mut body).expect("a frame");
    let mut body = unstuffed[..unstuffed.len() - 4].to_vec();
    alter(&mut body);
    let mut stuffed = [&[0], &body[..], &crc_of(&body)].concat();
    lashloop_protocol::cobs::stuff(&mut stuffed);
    [&stuffed[..], &[DELIMITER]].concat()
}

fn good_crc(body: &[u8]) -> [u8; 4] {
    crc::checksum(body).to_le_bytes()
}

fn boot_log() -> Vec<u8> {
    frame(Log { level: LogLevel::Info, text: Text::new("supply 24.1 V, encoder found") })
}

fn torque() -> Vec<u8> {
    let status = TorqueStatus { state: State::Idle, flags: TorqueFlags::empty() };
    frame(TorqueAnswer { sequence: 0, torque_nm: 0.0, status, compute_tenths_us: 0 })
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
        let is_hello = bytes.len() == 12;
        let bytes = if is_hello { frame(identity(SESSION)) } else { Vec::new() };
        bytes.into_iter().map(|byte| (100 * MS, vec![byte])).collect()
    })
}

/// Every trouble of a handshake and the far end that causes it.
fn troubles() -> Vec<(&'static str, Peer)> {
    let other_crc =
        |crc_of: fn(&[u8]) -> [u8; 4]| identifying(move |session| altered(session, |_| {}, crc_of));
    let foreign_hello = || HostMessage::from(Hello { protocol_version: 1, session: 7 }).frame().to_vec();
    vec![
        ("nothing", Peer::replying(|_| Vec::new())),
        ("own frames", Peer::replying(|bytes| vec![(MS, bytes.to_vec())])),
        ("cooked echo", cooked_echo()),
        ("another host", Peer::streaming(100 * MS, foreign_hello)),
        ("answers without a request", Peer::streaming(20 * MS, torque)),
        ("state out of its list", identifying(|session| altered(session, |body| body[14] = 9, good_crc))),
        ("board no text", identifying(|session| altered(session, |body| body[15] = 0xff, good_crc))),
        ("body too short", identifying(|session| altered(session, |body| body.truncate(45), good_crc))),
        ("constant session", identifying(|_| frame(identity(42)))),
        ("session big endian", identifying(|session| frame(identity(session.swap_bytes())))),
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
        ("state out of its list", "Identity with state 9, no value of State"),
        ("body too short", "Identity with a body of 45 bytes instead of 46"),
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
        ("logs alone", Cause::OtherAnswers),
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
            let is_first = bytes.len() == 12 && !std::mem::replace(&mut sent, true);
            let bytes = if is_first { frame(identity(SESSION)) } else { Vec::new() };
            bytes.into_iter().map(|byte| (pause_ms * MS, vec![byte])).collect()
        });
        assert_eq!(diagnosis(peer).cause, Cause::Trickle, "{pause_ms} ms");
    }
}

#[test]
fn an_echo_in_front_of_a_drive_does_no_harm() {
    let mut drive = identifying(|session| frame(identity(session)));
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

/// A drive with 16 laws and 255 parameters of 256 choices each that answers each request but `Hello` after `delay`.
fn talkative(delay: Duration) -> Peer {
    Peer::answering_after(move |request| {
        let delay = if matches!(request, HostMessage::Hello(_)) { MS } else { delay };
        let answer = match request {
            HostMessage::Hello(Hello { session, .. }) => {
                frame(Identity { law_count: 16, parameter_count: u8::MAX, ..identity(session) })
            }
            HostMessage::DescribeLaw(it) => frame(LawDescription { index: it.index, name: Text::new("law") }),
            HostMessage::DescribeParameter(it) => frame(ParameterDescription {
                index: it.index,
                flags: ParameterFlags::CHOICES,
                laws: u16::MAX,
                default: ParameterValue::U32(0),
                min: ParameterValue::U32(0),
                max: ParameterValue::U32(255),
                name: Text::new("parameter"),
                unit: Text::new(""),
            }),
            HostMessage::DescribeChoice(it) => frame(ChoiceDescription {
                parameter: it.parameter,
                choice: it.choice,
                name: Text::new("choice"),
            }),
            other => panic!("{other:?} before the description is complete"),
        };
        Some((delay, answer))
    })
}

#[test]
fn answers_just_in_time_hold_no_session_beyond_its_patience() {
    for delay_ms in [300, 490, 700, 1990] {
        let delay = Duration::from_millis(delay_ms);
        let error = failure(talkative(delay), PATIENCE + Duration::from_secs(3));
        match error {
            SessionError::Slow { limit, requests, .. } => {
                assert_eq!(limit, PATIENCE, "{delay:?}");
                assert!(requests >= 8, "{delay:?}: {requests} requests");
            }
            SessionError::Silent { .. } => assert!(delay_ms > 500, "{delay:?}: {error}"),
            _ => panic!("{delay:?}: {error}"),
        }
    }
}

#[test]
fn telemetry_behind_the_last_answer_is_no_answer() {
    let mut session = Some(());
    let peer = Peer::answering(MS, move |request| match request {
        HostMessage::Hello(Hello { session: number, .. }) => {
            session.take().map(|()| [frame(identity(number)), boot_log()].concat())
        }
        _ => None,
    });
    let error = failure(peer, Duration::from_secs(3));
    let SessionError::Silent { ref diagnosis, .. } = error else { panic!("{error}") };
    assert_eq!((&diagnosis.cause, diagnosis.arrivals.good_count()), (&Cause::Hang, 1));
    assert!(error.to_string().starts_with("the drive was silent for 2.0 s after DescribeLaw"), "{error}");
}
