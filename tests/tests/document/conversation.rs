//! The conversation of the document, byte by byte, with the drive itself.

use std::cell::Cell;
use std::time::Duration;

use lashloop_firmware::drive::{BUILD_ID, Clock, Drive, FIRMWARE_VERSION};
use lashloop_protocol::message::Identity;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message};

use crate::markdown::{fences, section};

/// A clock that goes on by this each time it is asked.
const STEP: Duration = Duration::from_nanos(5_700);

struct Stepping(Cell<Duration>);

impl Clock for Stepping {
    fn now(&self) -> Duration {
        self.0.replace(self.0.get() + STEP)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Host,
    Drive,
}

/// Who says which frame.
fn script() -> Vec<(Side, Vec<u8>)> {
    let sheets = fences(section("## 13. A conversation, byte by byte"));
    let frame = |sheet: &str| {
        let side = if sheet.contains("host -> drive") { Side::Host } else { Side::Drive };
        let (_, digits) = sheet.rsplit_once("frame: ").expect("every piece ends with its frame");
        let byte = |digits| u8::from_str_radix(digits, 16).expect("two hexadecimal digits");
        (side, digits.split_whitespace().map(byte).collect())
    };
    sheets.into_iter().map(frame).collect()
}

/// The document shows some build; the rest of its identity is this one's.
fn of_this_build(frame: &[u8]) -> Vec<u8> {
    match Decoder::new().next(&mut &frame[..]) {
        Some(Ok(DriveMessage::Identity(identity))) => {
            let identity = Identity { firmware: FIRMWARE_VERSION, build_id: BUILD_ID, ..identity };
            DriveMessage::from(identity).frame().to_vec()
        }
        _ => frame.to_vec(),
    }
}

fn name_of(frame: &[u8]) -> &'static str {
    match Decoder::new().next::<HostMessage>(&mut &frame[..]) {
        Some(Ok(message)) => message.layout().name,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_drive_says_what_the_document_has_it_say() {
    let (mut drive, clock) = (Drive::new("stm32f405"), Stepping(Cell::default()));
    drive.receive(&[0], &clock);
    assert!(drive.output().is_empty(), "the drive does not answer a boundary byte");
    let script = script();
    for turn in script.chunk_by(|_, next| next.0 == Side::Drive) {
        let [(Side::Host, said), answers @ ..] = turn else { panic!("the host begins") };
        assert_eq!(drive.receive(said, &clock), said.len());
        let want: Vec<u8> = answers.iter().flat_map(|(_, frame)| of_this_build(frame)).collect();
        assert_eq!(drive.output(), want, "answers to {}", name_of(said));
        drive.clear_output();
    }
}

#[test]
fn the_conversation_goes_from_the_greeting_to_the_stop() {
    let said = script().into_iter().filter(|(side, _)| *side == Side::Host);
    let names: Vec<_> = said.map(|(_, frame)| name_of(&frame)).collect();
    let want = ["Hello", "SetParameter", "Arm", "Start", "EncoderSample", "EncoderSample", "Stop"];
    assert_eq!(names, want);
}
