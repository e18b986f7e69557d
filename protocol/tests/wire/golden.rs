//! `protocol/golden/v1.json`: one frame of every kind, with its fields, for implementations in other languages.
//!
//! Do not change these frames: drives in the field use them. A new protocol version gets a file of its own.

use std::fs;

use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::field_value::{FieldValue, SetFlags};
use lashloop_protocol::hex::Hex;
use lashloop_protocol::layout::FieldLayout;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, MINOR_VERSION, Message, PROTOCOL_VERSION};
use serde_json::Value;

use crate::data_sheet::body_of;
use crate::digits::bytes_of;
use crate::examples::{self, NUMBER};

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/v1.json");

/// The file, one message per line, so that a difference names its message.
fn document() -> String {
    let frames: Vec<String> =
        (examples::from_host().iter().map(entry)).chain(examples::from_drive().iter().map(entry)).collect();
    format!(
        "{{\n  \"protocol_version\": {PROTOCOL_VERSION},\n  \"minor_version\": {MINOR_VERSION},\n  \"frames\": [\n    {}\n  ]\n}}\n",
        frames.join(",\n    ")
    )
}

fn entry<M: Message>(message: &M) -> String {
    let (layout, body) = (message.layout(), body_of(message));
    let field = |field: &FieldLayout| {
        let value = field.value(&body).expect("a field of this body");
        format!("{}: {}", Value::from(field.name), json(value))
    };
    let fields: Vec<String> = layout.fields.iter().map(field).collect();
    format!(
        "{{\"name\": \"{}\", \"kind\": {}, \"number\": {}, \"frame\": \"{}\", \"fields\": {{{}}}}}",
        layout.name,
        layout.kind,
        if layout.has_number() { NUMBER } else { 0 },
        Hex(&message.numbered_frame(NUMBER)),
        fields.join(", ")
    )
}

/// Reals as the shortest decimal that reads back as the same binary32, names instead of bytes.
fn json(value: FieldValue) -> String {
    let names = |flags: SetFlags| Value::from(flags.iter().map(|flag| flag.to_string()).collect::<Vec<_>>());
    match value {
        FieldValue::Unsigned(value) => value.to_string(),
        FieldValue::Signed(value) => value.to_string(),
        FieldValue::Real(value) => format!("{value:?}"),
        FieldValue::Reals(values) => {
            let values: Vec<_> = values.as_slice().iter().map(|value| format!("{value:?}")).collect();
            format!("[{}]", values.join(", "))
        }
        FieldValue::Name(value) => Value::from(value.to_string()).to_string(),
        FieldValue::Flags(flags) => names(flags).to_string(),
        FieldValue::Status(state, flags) => {
            format!("{{\"state\": {}, \"flags\": {}}}", Value::from(state.to_string()), names(flags))
        }
        FieldValue::Text(text) => Value::from(text).to_string(),
        FieldValue::Parameter(value) => {
            let number = match value {
                ParameterValue::U32(value) => value.to_string(),
                ParameterValue::F32(value) => format!("{value:?}"),
                ParameterValue::Unknown { .. } => format!("\"{value}\""),
            };
            format!("{{\"type\": \"{}\", \"value\": {number}}}", value.ty())
        }
        FieldValue::Version(version) => format!("\"{version}\""),
    }
}

/// With `INSTA_UPDATE=unseen`, which also adds missing snapshots, frames of new messages are added to the file. A frame of the
/// file is never changed.
#[test]
fn the_golden_frames_are_those_of_the_code() {
    let want = document();
    let have = fs::read_to_string(PATH).unwrap_or_default();
    let added_only = have.lines().all(|line| want.contains(line.trim_end_matches(',')));
    if added_only && std::env::var("INSTA_UPDATE").is_ok_and(|mode| mode == "unseen") {
        fs::write(PATH, &want).expect("golden/v1.json is writable");
        return;
    }
    let differing = have.lines().zip(want.lines()).find(|(have, want)| have != want);
    assert_eq!(differing, None, "a frame was added or changed");
    assert_eq!(have.len(), want.len(), "a frame was added or removed");
}

#[test]
fn the_golden_frames_decode_to_their_messages() {
    let file: Value =
        serde_json::from_str(&fs::read_to_string(PATH).expect("a committed file")).expect("JSON");
    let frames = file["frames"].as_array().expect("an array");
    assert_eq!(frames.len(), HostMessage::LAYOUTS.len() + DriveMessage::LAYOUTS.len());
    for entry in frames {
        let frame = bytes_of(entry["frame"].as_str().expect("hexadecimal digits"));
        let name = if entry["kind"].as_u64() < Some(0x80) {
            let message = Decoder::new().next::<HostMessage>(&mut &frame[..]);
            message.and_then(Result::ok).map(|numbered| numbered.message.layout().name)
        } else {
            let message = Decoder::new().next::<DriveMessage>(&mut &frame[..]);
            message.and_then(Result::ok).map(|numbered| numbered.message.layout().name)
        };
        assert_eq!(name, entry["name"].as_str());
    }
}

#[test]
fn every_message_with_a_device_time_gives_access_to_it() {
    for mut message in examples::from_drive() {
        let layout = message.layout();
        let has_field = layout.fields.iter().any(|field| field.name == "device_time_us");
        let field = message.device_time_us_mut().copied();
        assert_eq!(field, has_field.then_some(examples::DEVICE_TIME_US), "{}", layout.name);
    }
}
