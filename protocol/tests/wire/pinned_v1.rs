//! Protocol version 1, byte for byte. Do not change these snapshots: drives in the field use these bytes. A change that breaks
//! them needs a new protocol version, with a file of its own.

use std::collections::BTreeSet;
use std::fmt::Debug;

use lashloop_protocol::layout::{Direction, MessageLayout};
use lashloop_protocol::message::Telemetry;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{
    Decoder, DriveMessage, HostMessage, MAX_BODY, MAX_FRAME, Message, Numbered, TelemetryValues,
};

use crate::data_sheet::{data_sheet, frame_bytes_of};
use crate::examples::{self, NUMBER};

fn pin<M: Message + Copy + Debug + PartialEq>(messages: &[M]) {
    assert_eq!(messages.len(), M::LAYOUTS.len(), "an example of every kind");
    for message in messages {
        let sheet = data_sheet(message);
        let name = sheet.split(',').next().unwrap_or_default().to_lowercase();
        insta::assert_snapshot!(format!("v1_{name}"), sheet);
        let decoded = Decoder::new().next::<M>(&mut &message.numbered_frame(NUMBER)[..]);
        let number = if message.layout().has_number() { NUMBER } else { 0 };
        assert_eq!(
            decoded,
            Some(Ok(Numbered { number, message: *message })),
            "{name} decodes to the same value"
        );
    }
}

fn layouts() -> impl Iterator<Item = &'static MessageLayout> {
    HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS)
}

#[test]
fn every_message_of_the_host_is_pinned() {
    pin(&examples::from_host());
}

#[test]
fn every_message_of_the_drive_is_pinned() {
    pin(&examples::from_drive());
}

#[test]
fn a_control_cycle_is_19_bytes_out_and_16_back() {
    assert_eq!(HostMessage::from(examples::SAMPLE).frame().len(), 19);
    assert_eq!(DriveMessage::from(examples::TORQUE).frame().len(), 16);
}

#[test]
fn telemetry_of_six_signals_is_33_bytes_and_of_thirteen_61() {
    for (count, bytes) in [(1, 13), (6, 33), (13, 61)] {
        let values = TelemetryValues::new(&[0.5; 13][..count]).expect("at most 13");
        let telemetry = DriveMessage::from(Telemetry { sequence: 0, values });
        assert_eq!(telemetry.frame().len(), bytes);
        assert_eq!(telemetry.layout().frame_len_of(count), Some(bytes));
    }
    let layout = Telemetry::LAYOUT;
    assert_eq!((layout.frame_len_of(0), layout.frame_len_of(14)), (None, None));
    assert_eq!(TelemetryValues::new(&[0.5; 14]), None);
}

#[test]
fn a_body_may_be_longer_but_not_shorter_than_its_fields() {
    for layout in layouts() {
        let lens: Vec<usize> = (0..=MAX_BODY).filter(|len| layout.takes(*len)).collect();
        let shortest = match layout.fields.last() {
            Some(last) if last.optional => layout.body_len - last.len,
            _ => layout.body_len,
        };
        if let "Telemetry" | "CaptureRows" = layout.name {
            let shortest = if layout.has_number() { 10 } else { 7 };
            assert_eq!(lens, (shortest..=MAX_BODY).step_by(4).collect::<Vec<_>>());
        } else {
            assert_eq!(lens, (shortest..=MAX_BODY).collect::<Vec<_>>(), "{}", layout.name);
        }
    }
}

#[test]
fn what_is_sent_in_every_period_or_unasked_has_no_number() {
    let without: Vec<_> = layouts().filter(|layout| !layout.has_number()).map(|layout| layout.name).collect();
    let unasked = ["TorqueAnswer", "Telemetry", "FaultReport", "Log", "BenchSample"];
    assert_eq!(without, [&["EncoderSample", "Reference"][..], &unasked].concat());
    for layout in layouts() {
        let first = layout.fields.first().map(|field| field.offset);
        assert!(first.is_none_or(|offset| offset == 1 + usize::from(layout.has_number())), "{}", layout.name);
    }
}

#[test]
fn no_frame_is_longer_than_the_limit() {
    let longest = layouts().max_by_key(|layout| layout.frame_len()).expect("there are messages");
    assert_eq!((longest.name, longest.frame_len()), ("Log", MAX_FRAME));
}

#[test]
fn kinds_are_unique_and_imply_the_direction() {
    let kinds: BTreeSet<_> = layouts().map(|layout| layout.kind).collect();
    assert_eq!(kinds.len(), layouts().count());
    for layout in layouts() {
        let from_drive = layout.direction == Direction::DriveToHost;
        assert_eq!(layout.kind & 0x80 != 0, from_drive, "{}", layout.name);
        assert_ne!(layout.kind & 0x7f, 0, "zero isn't a kind");
    }
}

#[test]
fn the_tables_of_messages_in_the_source_are_correct() {
    let tables =
        concat!(include_str!("../../src/message/host.rs"), include_str!("../../src/message/drive.rs"));
    for layout in layouts() {
        let line = format!("//! | `{:#04x}` | [`{}`] |", layout.kind, layout.name);
        let row =
            tables.lines().find(|row| row.starts_with(&line)).unwrap_or_else(|| panic!("no row {line}"));
        let frame_bytes = row.split('|').nth(3).map(str::trim);
        assert_eq!(frame_bytes, Some(frame_bytes_of(layout).as_str()), "{row}");
    }
}
