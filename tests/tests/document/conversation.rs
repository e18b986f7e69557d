//! The conversation of the document, byte by byte, against the drive.

use std::cell::Cell;
use std::time::Duration;

use lashloop_firmware::drive::{BUILD_ID, BUILD_IS_DIRTY, Clock, Drive, FIRMWARE_VERSION};
use lashloop_protocol::message::Identity;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message};

use crate::script::{Side, script};

/// Advance of the clock at each reading.
const STEP: Duration = Duration::from_nanos(5_700);

struct Stepping(Cell<Duration>);

impl Clock for Stepping {
    fn now(&self) -> Duration {
        self.0.replace(self.0.get() + STEP)
    }
}

/// The document shows one build; everything else of the identity must match.
fn of_this_build(frame: &[u8]) -> Vec<u8> {
    match Decoder::new().next(&mut &frame[..]) {
        Some(Ok(DriveMessage::Identity(identity))) => {
            let (firmware, build_id, dirty) = (FIRMWARE_VERSION, BUILD_ID, u8::from(BUILD_IS_DIRTY));
            let identity = Identity { firmware, build_id, dirty, ..identity };
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
fn the_drive_sends_the_documented_frames() {
    let (mut drive, clock) = (Drive::new("stm32f405"), Stepping(Cell::default()));
    drive.receive(&[0], &clock);
    assert!(drive.output().is_empty(), "the drive does not answer a boundary byte");
    let script = script();
    for turn in script.chunk_by(|_, next| next.0 == Side::Drive) {
        let [(Side::Host, request), answers @ ..] = turn else { panic!("the host begins") };
        assert_eq!(drive.receive(request, &clock), request.len());
        let want: Vec<u8> = answers.iter().flat_map(|(_, frame)| of_this_build(frame)).collect();
        assert_eq!(drive.output(), want, "answers to {}", name_of(request));
        drive.clear_output();
    }
}

#[test]
fn the_conversation_covers_handshake_to_stop() {
    let requests = script().into_iter().filter(|(side, _)| *side == Side::Host);
    let names: Vec<_> = requests.map(|(_, frame)| name_of(&frame)).collect();
    let want = [
        "Hello",
        "DescribeLaw",
        "DescribeSignal",
        "DescribeParameter",
        "DescribeChoice",
        "SetParameter",
        "Subscribe",
        "Arm",
        "Start",
        "EncoderSample",
        "EncoderSample",
        "Stop",
    ];
    assert_eq!(names, want);
}
