//! `protocol/golden/v1.json`: one frame of every kind, with its fields, for implementations in other languages.
//!
//! Do not change this test: drives in the field speak these bytes. A new protocol version gets a file of its own.

use std::fs;
use std::path::Path;

use lashloop_protocol::layout::{FieldType, MessageLayout};
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message, PROTOCOL_VERSION, cobs};
use serde_json::Value;

use crate::examples;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/v1.json");

/// The file, a message a line so that a difference shows where it is.
fn document() -> String {
    let frames: Vec<String> =
        (examples::from_host().iter().map(entry)).chain(examples::from_drive().iter().map(entry)).collect();
    format!(
        "{{\n  \"protocol_version\": {PROTOCOL_VERSION},\n  \"frames\": [\n    {}\n  ]\n}}\n",
        frames.join(",\n    ")
    )
}

fn entry<M: Message>(message: &M) -> String {
    let (layout, frame) = (message.layout(), message.frame());
    let fields: Vec<String> = fields(layout, &frame)
        .into_iter()
        .map(|(name, value)| format!("{}: {value}", Value::from(name)))
        .collect();
    let hex: String = frame.iter().map(|byte| format!("{byte:02x}")).collect();
    format!(
        "{{\"name\": \"{}\", \"kind\": {}, \"frame\": \"{hex}\", \"fields\": {{{}}}}}",
        layout.name,
        layout.kind,
        fields.join(", ")
    )
}

fn fields(layout: &MessageLayout, frame: &[u8]) -> Vec<(&'static str, String)> {
    let mut stuffed = frame[..frame.len() - 1].to_vec();
    let body = cobs::unstuff(&mut stuffed).expect("a frame of ours is stuffed as COBS asks");
    let field = |field: &lashloop_protocol::layout::FieldLayout| {
        (field.name, json(field.ty, &body[field.offset..field.offset + field.len]))
    };
    layout.fields.iter().map(field).collect()
}

fn word(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte))
}

/// Reals by the shortest decimal that gives the same binary32, names instead of bytes.
fn json(ty: FieldType, bytes: &[u8]) -> String {
    match ty {
        FieldType::U8 | FieldType::U16 | FieldType::U32 => word(bytes).to_string(),
        FieldType::I24 => (word(bytes) << 8).cast_signed().wrapping_shr(8).to_string(),
        FieldType::F32 => format!("{:?}", f32::from_bits(word(bytes))),
        FieldType::Enum(names) => {
            let (_, name) = names.iter().find(|(byte, _)| *byte == bytes[0]).expect("a named byte");
            Value::from(*name).to_string()
        }
        FieldType::Status { states, flags } => {
            let state = json(FieldType::Enum(states), &[bytes[0] & 0x0f]);
            format!("{{\"state\": {state}, \"flags\": {}}}", json(FieldType::Flags(flags), bytes))
        }
        FieldType::Flags(names) => {
            let set = names.iter().filter(|(mask, _)| word(bytes) & u32::from(*mask) != 0);
            Value::from(set.map(|(_, name)| *name).collect::<Vec<_>>()).to_string()
        }
        FieldType::Text => {
            let text = String::from_utf8(bytes.to_vec()).expect("UTF-8");
            Value::from(text.trim_end_matches('\0')).to_string()
        }
        FieldType::ParameterValue => {
            let (ty, value) = if bytes[0] == 1 { ("U32", FieldType::U32) } else { ("F32", FieldType::F32) };
            format!("{{\"type\": \"{ty}\", \"value\": {}}}", json(value, &bytes[1..]))
        }
        FieldType::Version => format!("\"{}.{}.{}\"", bytes[0], bytes[1], bytes[2]),
    }
}

#[test]
fn the_golden_frames_of_version_1_are_these() {
    let want = document();
    let have = fs::read_to_string(PATH).unwrap_or_default();
    let differing = have.lines().zip(want.lines()).find(|(have, want)| have != want);
    // For a new version, not for a change of this one.
    let fresh = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden.json");
    fs::write(&fresh, &want).expect("the folder for tests' files can be written");
    assert_eq!(differing, None, "the frames have changed; as they are now: {}", fresh.display());
    assert_eq!(
        have.len(),
        want.len(),
        "frames were added or taken away; as they are now: {}",
        fresh.display()
    );
}

#[test]
fn the_golden_file_is_json_whose_frames_are_good() {
    let file: Value =
        serde_json::from_str(&fs::read_to_string(PATH).expect("it is committed")).expect("JSON");
    let frames = file["frames"].as_array().expect("a list");
    assert_eq!(frames.len(), HostMessage::LAYOUTS.len() + DriveMessage::LAYOUTS.len());
    for entry in frames {
        let digits = entry["frame"].as_str().expect("hexadecimal digits");
        let byte = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).expect("two digits");
        let frame: Vec<u8> = (0..digits.len()).step_by(2).map(byte).collect();
        let name = if entry["kind"].as_u64() < Some(0x80) {
            let message = Decoder::new().next::<HostMessage>(&mut &frame[..]);
            message.and_then(Result::ok).map(|message| message.layout().name)
        } else {
            let message = Decoder::new().next::<DriveMessage>(&mut &frame[..]);
            message.and_then(Result::ok).map(|message| message.layout().name)
        };
        assert_eq!(name, entry["name"].as_str());
    }
}
