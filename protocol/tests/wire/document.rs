//! `docs/protocol.md` agrees with the code: every table of bytes, every list of values, the CRC, the limits and the bytes of
//! the example. The package `tests` verifies the behaviour of the drive.

use std::collections::BTreeSet;

use ::crc::CRC_32_ISCSI;
use lashloop_protocol::enums::{FLAG_SETS, VALUE_LISTS};
use lashloop_protocol::layout::{Direction, FieldLayout, FieldType, MessageLayout};
use lashloop_protocol::limits::{DELIMITER, MAX_LAWS, MAX_SIGNALS, MAX_TELEMETRY_VALUES, OVERHEAD};
use lashloop_protocol::message::{Telemetry, TorqueAnswer};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{
    Decoder, DriveMessage, HostMessage, MAX_BODY, MAX_FRAME, Message, PROTOCOL_VERSION, crc, parameter_names,
};

use crate::data_sheet::{data_sheet, frame_bytes_of, type_name};
use crate::digits::bytes_of;
use crate::markdown::{fences, section, table};

fn layouts() -> impl Iterator<Item = &'static MessageLayout> {
    HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS)
}

/// A number of the document, decimal or hexadecimal.
fn number(cell: &str) -> u32 {
    let parsed = match cell.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16),
        None => cell.parse(),
    };
    parsed.unwrap_or_else(|_| panic!("{cell:?} isn't a number"))
}

#[test]
fn every_message_has_a_table_of_its_bytes() {
    for layout in layouts() {
        let (name, body, frame) = (layout.name, layout.body_len, layout.frame_len());
        let (body, frame) = match layout.element_len {
            None => (body.to_string(), frame.to_string()),
            Some(step) => (
                format!("{} + {step} n", layout.shortest_body_len() - step),
                format!("{} + {step} n", layout.shortest_body_len() - step + OVERHEAD),
            ),
        };
        let section = section(&format!("### {name} ({:#04x})", layout.kind));
        let way = match layout.direction {
            Direction::HostToDrive => "Host to drive",
            Direction::DriveToHost => "Drive to host",
        };
        let plural = if body == "1" { "" } else { "s" };
        let facts = format!("{way}, body {body} byte{plural}, frame {frame} bytes. ");
        assert!(section.trim_start().starts_with(&facts), "{name} begins with {facts:?}: {section}");
        if layout.fields.is_empty() {
            assert!(!section.contains("| offset |"), "{name} has no fields: {section}");
            continue;
        }
        let rows = table(section, "offset");
        assert_eq!(rows.len(), layout.fields.len(), "fields of {name}");
        for (row, field) in rows.iter().zip(layout.fields) {
            let want = [field.offset.to_string(), length_of(field), field.name.to_owned(), type_name(field)];
            assert_eq!(row[..4], want, "{name}");
            assert_eq!(row.len(), 7, "columns of {name}.{}", field.name);
            assert!(!row[6].is_empty(), "{name}.{} has a meaning", field.name);
            for values in values_of(field.ty) {
                assert!(row[4].contains(&format!("[{values}](#")), "{name}.{} is of {values}", field.name);
            }
        }
    }
}

/// Length of a field, in the notation of the document.
fn length_of(field: &FieldLayout) -> String {
    if field.ty == FieldType::F32Repeated { "4 n".to_owned() } else { field.len.to_string() }
}

/// Names of the lists and flag sets of a field.
fn values_of(ty: FieldType) -> Vec<&'static str> {
    match ty {
        FieldType::Enum(list) => vec![list.name],
        FieldType::Flags(set) => vec![set.name],
        FieldType::Status { states, flags } => vec![states.name, flags.name],
        FieldType::ParameterValue => vec!["ParameterType"],
        FieldType::U8
        | FieldType::U16
        | FieldType::U32
        | FieldType::I24
        | FieldType::F32
        | FieldType::F32Repeated
        | FieldType::Text
        | FieldType::Version => Vec::new(),
    }
}

#[test]
fn every_described_message_exists() {
    let text = crate::markdown::PROTOCOL;
    let described = text.lines().filter(|line| line.starts_with("### ") && line.contains("(0x")).count();
    assert_eq!(described, layouts().count());
}

#[test]
fn the_list_of_messages_is_complete() {
    let rows = table(section("## 4. Messages"), "kind");
    assert_eq!(rows.len(), layouts().count());
    for (row, layout) in rows.iter().zip(layouts()) {
        let sender = if layout.direction == Direction::HostToDrive { "host" } else { "drive" };
        let kind = format!("{:#04x}", layout.kind);
        assert_eq!(row[..4], [kind, layout.name.into(), sender.into(), frame_bytes_of(layout)]);
    }
}

#[test]
fn every_field_type_is_documented_with_its_length() {
    let rows = table(section("## 3. Types of fields"), "type");
    let documented: BTreeSet<_> = rows.iter().map(|row| (row[0].as_str(), row[1].as_str())).collect();
    for (layout, field) in layouts().flat_map(|layout| layout.fields.iter().map(move |field| (layout, field)))
    {
        let (name, len) = (type_name(field), length_of(field));
        let wanted = if field.ty == FieldType::Text { ("text[n]", "n") } else { (&*name, &*len) };
        assert!(documented.contains(&wanted), "{}.{} is {wanted:?}", layout.name, field.name);
    }
}

#[test]
fn lists_of_values_are_complete() {
    let fields = layouts().flat_map(|layout| layout.fields).flat_map(|field| values_of(field.ty));
    for name in fields {
        let known =
            VALUE_LISTS.iter().any(|list| list.name == name) || FLAG_SETS.iter().any(|set| set.name == name);
        assert!(known, "{name} is missing in enums/mod.rs");
    }
    let documented = |name: &str, header: &str| -> Vec<(u32, String)> {
        let rows = table(section(&format!("### {name}")), header);
        rows.into_iter().map(|row| (number(&row[0]), row[1].clone())).collect()
    };
    for list in VALUE_LISTS {
        let want: Vec<_> =
            list.values.iter().map(|(byte, name)| (u32::from(*byte), (*name).to_owned())).collect();
        assert_eq!(documented(list.name, "byte"), want, "{}", list.name);
    }
    for set in FLAG_SETS {
        let want: Vec<_> =
            set.flags.iter().map(|(mask, name)| (u32::from(*mask), (*name).to_owned())).collect();
        assert_eq!(documented(set.name, "mask"), want, "{}", set.name);
    }
}

#[test]
fn the_limits_are_those_of_the_code() {
    assert!(
        crate::markdown::PROTOCOL.starts_with(&format!("# The wire protocol, version {PROTOCOL_VERSION}\n"))
    );
    let rows = table(section("## 2. Frames"), "limit");
    let have: Vec<_> = rows.iter().map(|row| (row[0].as_str(), number(&row[1]) as usize)).collect();
    let want = [
        ("PROTOCOL_VERSION", usize::from(PROTOCOL_VERSION)),
        ("MAX_FRAME", MAX_FRAME),
        ("MAX_BODY", MAX_BODY),
        ("OVERHEAD", OVERHEAD),
        ("DELIMITER", usize::from(DELIMITER)),
        ("MAX_LAWS", MAX_LAWS),
        ("MAX_SIGNALS", MAX_SIGNALS),
        ("MAX_TELEMETRY_VALUES", MAX_TELEMETRY_VALUES),
    ];
    assert_eq!(have, want);
}

/// Bits of a byte on a UART: start, 8 data bits, stop.
const BITS_PER_BYTE: f64 = 10.0;

#[test]
fn the_telemetry_budget_is_that_of_the_frames() {
    let us = |bytes: usize| (bytes as f64 * BITS_PER_BYTE / 921_600.0 * 1e6).round() as u32;
    let torque = TorqueAnswer::LAYOUT.frame_len();
    let section = section("### Budget");
    for row in table(section, "n") {
        let frame = Telemetry::LAYOUT.frame_len_of(number(&row[0]) as usize).expect("a number of values");
        let want = [frame as u32, us(frame), us(torque + frame)];
        assert_eq!([&row[1], &row[2], &row[3]].map(|cell| number(cell)), want, "{row:?}");
    }
    for row in table(section, "bit/s") {
        let bytes_per_period = f64::from(number(&row[0])) / BITS_PER_BYTE * 1e-3;
        assert_eq!(row[1], format!("{bytes_per_period:.1}"), "{row:?}");
        let fits =
            |n: &usize| (torque + Telemetry::LAYOUT.frame_len_of(*n).unwrap()) as f64 <= bytes_per_period;
        let largest = (1..=MAX_TELEMETRY_VALUES).filter(fits).max().unwrap_or(0);
        let want = if torque as f64 > bytes_per_period { "no loop" } else { &largest.to_string() };
        assert!(row[2].starts_with(want), "{row:?}: {want}");
    }
    let mean = torque as f64 + Telemetry::LAYOUT.frame_len_of(6).unwrap() as f64 / 10.0;
    let fraction = mean / (921_600.0 / BITS_PER_BYTE * 1e-3);
    let example = format!("{mean:.1} bytes or {:.0} % of 921,600 bit/s", 100.0 * fraction);
    assert!(section.contains(&example), "the document has {example:?}");
}

#[test]
fn reserved_names_are_those_of_the_code() {
    let names: Vec<_> =
        table(section("### Reserved names"), "name").into_iter().map(|mut row| row.swap_remove(0)).collect();
    assert_eq!(names, parameter_names::RESERVED);
}

#[test]
fn a_minimal_drive_has_the_parameters_that_are_always_required() {
    let rows = table(section("### Reserved names"), "name");
    let required: Vec<_> = rows.iter().filter(|row| row[2] == "always").map(|row| &*row[0]).collect();
    assert_eq!(required, parameter_names::REQUIRED);
    let count = format!("`signal_count` 0 and `parameter_count` {};", required.len());
    assert!(section("## 10. Laws, signals and choices").contains(&count), "the minimal drive has {count:?}");
}

#[test]
fn the_crc_is_that_of_the_code() {
    let section = section("### CRC");
    let rows = table(section, "");
    let fact = |name: &str| {
        let row = rows.iter().find(|row| row[0] == name);
        row.unwrap_or_else(|| panic!("nothing about the {name}"))[1].as_str()
    };
    let want = CRC_32_ISCSI;
    assert_eq!(crc::checksum(b"123456789"), want.check, "frames carry another CRC");
    assert!(fact("name").starts_with("CRC-32/ISCSI"));
    let numbers = [
        ("width", 32),
        ("polynomial", want.poly),
        ("initial value", want.init),
        ("final xor", want.xorout),
        ("check value", want.check),
        ("residue", want.residue),
    ];
    for (name, want) in numbers {
        assert_eq!(number(fact(name)), want, "{name}");
    }
    assert_eq!(fact("input reflected"), want.refin.to_string());
    assert_eq!(fact("output reflected"), want.refout.to_string());
    let reflected = format!("{:#010x}", want.poly.reverse_bits());
    assert!(fences(section)[0].contains(&reflected), "the loop in C divides by {reflected}");
    for row in table(section, "body and CRC of") {
        let layout = layouts().find(|layout| layout.name == row[0]).expect("a message");
        assert_eq!(number(&row[1]) as usize, (layout.body_len + crc::LEN) * 8, "{}", layout.name);
    }
}

#[test]
fn the_frames_of_the_example_decode_as_described() {
    let sheets = fences(section("## 15. A conversation, byte by byte"));
    assert!(sheets.len() > 10, "{} frames", sheets.len());
    for sheet in sheets {
        let (_, digits) = sheet.rsplit_once("frame: ").unwrap_or_else(|| panic!("no frame in {sheet}"));
        let frame = bytes_of(digits);
        let want = if sheet.contains("host -> drive") {
            Decoder::new().next::<HostMessage>(&mut &frame[..]).map(|it| it.map(|it| data_sheet(&it)))
        } else {
            Decoder::new().next::<DriveMessage>(&mut &frame[..]).map(|it| it.map(|it| data_sheet(&it)))
        };
        assert_eq!(want, Some(Ok(sheet.to_owned())));
    }
}
