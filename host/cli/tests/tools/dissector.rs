//! The Wireshark dissector against the layouts, and against a real run.

use std::collections::HashMap;
use std::fs;
use std::path::PathBuf;

use lashloop_decode::capture::pcapng;
use lashloop_decode::message::AnyMessage;
use lashloop_decode::{DecodedMessage, StreamReader};
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::field_value::{FieldValue, SetFlags};
use lashloop_protocol::layout::{Direction, FieldType};
use lashloop_protocol::{Frame, Message};
use tempfile::TempDir;

use crate::examples::NUMBER;
use crate::support::{example_frame, example_frames, root, short_run, subscribed_frames, tshark};

const INFO_ALONE: [&str; 2] = ["-o", "gui.column.format:\"Info\",\"%i\""];

fn script() -> String {
    fs::read_to_string(root().join("tools/wireshark/lashloop.lua")).unwrap()
}

fn capture(frames: &[Vec<u8>]) -> (TempDir, PathBuf) {
    let mut bytes = pcapng::file_header();
    for (at, frame) in frames.iter().enumerate() {
        pcapng::append_packet(&mut bytes, at as u64, Direction::HostToDrive, frame);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.pcapng");
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// The dissector's layer of every packet.
fn layers(capture: &std::path::Path) -> Option<Vec<serde_json::Value>> {
    let json = tshark(capture, &["-T", "json", "--no-duplicate-keys"])?;
    let packets: Vec<serde_json::Value> = serde_json::from_str(&json).unwrap();
    Some(packets.into_iter().map(|mut packet| packet["_source"]["layers"]["lashloop"].take()).collect())
}

#[test]
fn the_script_names_every_message_field_and_value_of_the_layouts() {
    let script = script();
    let after = |text: &str, from: usize, what: &str| {
        from + script[from..].find(text).unwrap_or_else(|| panic!("{what}: no {text} where it should be"))
    };
    for layout in AnyMessage::LAYOUTS {
        let mut at = after(&format!("[{:#04x}] = {{ \"{}\"", layout.kind, layout.name), 0, layout.name);
        let end = script[at + 1..].find("[0x").map_or(script.len(), |next| at + 1 + next);
        for field in layout.fields {
            at = after(&format!("{{ \"{}\", ", field.name), at, layout.name);
            assert!(at < end, "{}.{} is not among its fields", layout.name, field.name);
            let names: Vec<_> = match field.ty {
                FieldType::Enum(names) => {
                    names.values.iter().map(|(byte, name)| format!("[{byte}] = \"{name}\"")).collect()
                }
                FieldType::Flags(names) => {
                    names.flags.iter().map(|(mask, name)| format!("[{mask}] = \"{name}\"")).collect()
                }
                FieldType::Status { states, flags } => states
                    .values
                    .iter()
                    .map(|(value, name)| format!("[{value}] = \"{name}\""))
                    .chain(flags.flags.iter().map(|(mask, name)| format!("[{mask}] = \"{name}\"")))
                    .collect(),
                _ => Vec::new(),
            };
            for name in names {
                after(&name, 0, field.name);
            }
        }
    }
}

#[test]
fn every_field_of_every_pinned_message_is_read_as_we_read_it() {
    let frames = example_frames();
    let (_folder, path) = capture(&frames);
    let Some(layers) = layers(&path) else { return };
    assert_eq!(layers.len(), AnyMessage::LAYOUTS.len(), "all kinds of messages");
    for (frame, layer) in frames.iter().zip(layers) {
        let found = found(frame);
        let shown = |name: &str| {
            let text = layer[format!("lashloop.{name}")].as_str();
            text.unwrap_or_else(|| panic!("{} shows no {name}: {layer:#}", found.layout.name)).to_owned()
        };
        assert_eq!(shown("kind"), format!("{:#04x}", found.layout.kind));
        assert_eq!(shown("crc.status"), "1");
        let of_request = found.layout.has_number().then(|| NUMBER.to_string());
        assert_eq!(layer["lashloop.number"].as_str(), of_request.as_deref(), "{}", found.layout.name);
        assert_eq!(layer["lashloop.newer"].as_str(), None, "{}", found.layout.name);
        for (layout, value) in found.fields() {
            // `lashloop.number` is the number of a request, `lashloop.level` that of a log.
            let name = match (layout.name, layout.ty) {
                ("number", _) => "reference_number",
                ("level", FieldType::F32) => "trigger_level",
                (name, _) => name,
            };
            match value {
                FieldValue::Unsigned(value) => assert_eq!(shown(name), value.to_string(), "{name}"),
                FieldValue::Signed(value) => assert_eq!(shown(name), value.to_string(), "{name}"),
                FieldValue::Real(value) => assert_eq!(shown(name).parse(), Ok(value), "{name}"),
                FieldValue::Reals(values) => {
                    let shown = layer[format!("lashloop.{name}")].as_array().expect("several values");
                    let shown: Vec<f32> =
                        shown.iter().map(|it| it.as_str().unwrap().parse().unwrap()).collect();
                    assert_eq!(shown, values.as_slice(), "{name}");
                }
                FieldValue::Name(value) => assert_eq!(shown(name), value.byte.to_string(), "{name}"),
                FieldValue::Flags(flags) => {
                    let FieldType::Flags(names) = layout.ty else { panic!("{name} has no flags") };
                    assert_eq!(number(&shown(name)), bits(names.flags, flags), "{name}");
                }
                FieldValue::Status(state, flags) => {
                    let FieldType::Status { flags: names, .. } = layout.ty else {
                        panic!("{name} isn't a status")
                    };
                    let below = &layer[format!("lashloop.{name}_tree")];
                    assert_eq!(below[format!("lashloop.{name}.state")], state.byte.to_string(), "{name}");
                    let whole = bits(names.flags, flags) | state.byte;
                    assert_eq!(number(&shown(name)), whole, "{name}");
                }
                FieldValue::Text(value) => assert_eq!(shown(name), value, "{name}"),
                FieldValue::Parameter(ParameterValue::U32(value)) => {
                    assert_eq!(
                        (shown(&format!("{name}.type")), shown(&format!("{name}.u32"))),
                        ("1".into(), value.to_string())
                    );
                }
                FieldValue::Parameter(ParameterValue::F32(value)) => {
                    assert_eq!(shown(&format!("{name}.type")), "2");
                    assert_eq!(shown(&format!("{name}.f32")).parse(), Ok(value), "{name}");
                }
                FieldValue::Parameter(ParameterValue::Unknown { .. }) => {
                    panic!("{name} has a type without a name")
                }
                FieldValue::Version(value) => assert_eq!(shown(name), value.to_string(), "{name}"),
            }
        }
    }
}

fn bits(names: &[(u8, &str)], set: SetFlags) -> u8 {
    names.iter().filter(|(_, name)| set.iter().any(|it| it.to_string() == *name)).map(|(mask, _)| mask).sum()
}

/// A number that is shown in hexadecimal digits.
fn number(shown: &str) -> u8 {
    u8::from_str_radix(shown.trim_start_matches("0x"), 16).unwrap()
}

fn found(frame: &[u8]) -> DecodedMessage {
    let mut found = None;
    StreamReader::default().push(frame, |entry| found = entry.message.ok());
    found.expect("a whole frame")
}

#[test]
fn the_info_column_says_what_one_wants_to_know() {
    let (_folder, path) = capture(&example_frames());
    let Some(info) = tshark(&path, &INFO_ALONE) else { return };
    insta::assert_snapshot!(info);
}

#[test]
fn telemetry_has_the_names_of_the_subscribed_signals() {
    let (_folder, path) = capture(&subscribed_frames());
    let Some(info) = tshark(&path, &INFO_ALONE) else { return };
    insta::assert_snapshot!(info);
    // Two passes: packets are shown again, out of order with those that name their signals.
    let two_passes = tshark(&path, &[&["-2"], &INFO_ALONE[..]].concat());
    assert_eq!(two_passes.as_deref(), Some(info.as_str()));
}

#[test]
fn what_a_newer_version_adds_is_shown_and_not_refused() {
    let inside_time: &[u8] = &[0x85, 7, 5, 1, 3, 0, 0, 0, 0, 1, 2, 3];
    let of_fault = [&[0x92, 77, 2, 1][..], &[0; 8], &[9, 0, 0, 0]].concat();
    let of_parameter = [&[0x82, 7, 3, 0x83, 1, 0][..], &[77, 1, 2, 3, 4], &[9; 10], &[b'x'; 37]].concat();
    let bodies: [&[u8]; 13] = [
        // Kinds: with number and bytes, alone, without a number.
        &[0x42, 7, 0xa1, 0xa2, 0xa3],
        &[0x42],
        &[0x1f, 0xa1],
        &[0xf0, 7, 0xa1],
        // Bytes after the fields, and fewer than those of the optional field.
        &[0x07, 7, 0xa1, 0xa2],
        &[0x85, 7, 6, 2, 1, 0, 0, 0, 0, 4, 3, 2, 1, 0xa1, 0xa2, 0xa3, 0xa4, 0xa5],
        inside_time,
        // Values and flags.
        &[0x85, 7, 0x42, 77, 9, 5, 0, 0, 0],
        &[0x90, 2, 1, 0, 0, 0, 0, 0xc9, 0, 0],
        &of_parameter,
        &[0x83, 7, 3, 1, 77, 1, 2, 3, 4, 2, 0, 0, 0, 0],
        &[0x04, 7, 3, 77, 0xff, 0xff, 0xff, 0xff],
        &of_fault,
    ];
    let frames: Vec<_> = bodies.iter().map(|body| Frame::around(body).to_vec()).collect();
    let (_folder, path) = capture(&frames);
    let Some(info) = tshark(&path, &INFO_ALONE) else { return };
    insta::assert_snapshot!(info);
    let shown = |filter: &str, field: &str| {
        let text = tshark(&path, &["-Y", filter, "-T", "fields", "-e", "frame.number", "-e", field]).unwrap();
        text.trim_end().replace('\t', " ")
    };
    assert_eq!(shown("lashloop.refused || lashloop.malformed", "lashloop.kind"), "");
    let newer = "1 a1a2a3\n3 a1\n4 a1\n5 a1a2\n6 a1a2a3a4a5\n7 010203";
    assert_eq!(shown("lashloop.newer", "lashloop.newer"), newer);
    assert_eq!(shown("lashloop.device_time_us", "lashloop.device_time_us"), "6 16909060");
    assert_eq!(shown("lashloop.value.unknown == 0x04030201", "lashloop.value.type"), "11 77");
}

#[test]
fn bad_frames_are_marked_and_the_next_one_is_good() {
    let torque = example_frame("TorqueAnswer");
    let mut flipped = torque.clone();
    flipped[6] ^= 1;
    let frames = [vec![0], flipped, vec![9, 9, 0], vec![2, 5, 0], vec![7; 80], torque];
    let (_folder, path) = capture(&frames);
    let Some(info) = tshark(&path, &INFO_ALONE) else { return };
    insta::assert_snapshot!(info);
    let bad_crc = tshark(
        &path,
        &["-Y", "lashloop.crc.bad", "-T", "fields", "-e", "frame.number", "-e", "lashloop.crc.status"],
    );
    assert_eq!(bad_crc.unwrap().trim(), "2\t0", "expert info and status of the flipped frame alone");
    let malformed =
        tshark(&path, &["-Y", "lashloop.malformed", "-T", "fields", "-e", "frame.number"]).unwrap();
    assert_eq!(malformed.split_whitespace().collect::<Vec<_>>(), ["3", "4", "5"]);
}

#[test]
fn tshark_reads_the_torques_of_a_real_run_as_the_trace_has_them() {
    let run = short_run();
    let fields = ["-T", "fields", "-e", "lashloop.sequence", "-e", "lashloop.torque_nm"];
    let Some(answers) = tshark(&run.capture, &[&["-Y", "lashloop.kind == 0x90"][..], &fields].concat())
    else {
        return;
    };
    let answers: HashMap<usize, f32> = answers
        .lines()
        .map(|line| {
            let (sequence, torque) = line.split_once('\t').unwrap();
            (sequence.parse().unwrap(), torque.parse().unwrap())
        })
        .collect();
    assert_eq!(answers.len(), run.torques_nm.len());
    for (sequence, torque_nm) in run.torques_nm.iter().enumerate() {
        assert_eq!(f64::from(answers[&sequence]), *torque_nm, "sequence {sequence}");
    }
    let bad = tshark(&run.capture, &["-Y", "lashloop.crc.status == 0 || _ws.expert"]).unwrap();
    assert_eq!(bad, "");
    let inbound =
        tshark(&run.capture, &["-Y", "frame.packet_flags_direction == 1 && lashloop.kind < 0x80"]).unwrap();
    assert_eq!(inbound, "", "messages of the host are outbound");
}
