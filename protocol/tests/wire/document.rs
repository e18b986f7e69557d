//! `docs/protocol.md` against the code: every table of bytes, every list of values, the CRC, the limits and the bytes of
//! the example. What the drive does is held against it in the package `tests`, which knows the drive.

use std::collections::BTreeSet;

use ::crc::CRC_32_ISCSI;
use lashloop_protocol::enums::{
    ControllerId, Controllers, DisturbingTorqueSource, FaultCode, LogLevel, Outcome, ParameterType, State,
    TorqueFlags,
};
use lashloop_protocol::frame::{DELIMITER, OVERHEAD};
use lashloop_protocol::layout::{Direction, FieldType, MessageLayout};
use lashloop_protocol::wire::Wire;
use lashloop_protocol::{
    Decoder, DriveMessage, HostMessage, MAX_BODY, MAX_FRAME, Message, PROTOCOL_VERSION, crc,
};

use crate::data_sheet::{data_sheet, type_name};
use crate::markdown::{fences, section, table};

const LISTS: [(&str, &[(u8, &str)]); 7] = [
    ("State", State::NAMES),
    ("FaultCode", FaultCode::NAMES),
    ("Outcome", Outcome::NAMES),
    ("LogLevel", LogLevel::NAMES),
    ("ParameterType", ParameterType::NAMES),
    ("ControllerId", ControllerId::NAMES),
    ("DisturbingTorqueSource", DisturbingTorqueSource::NAMES),
];

const FLAGS: [(&str, FieldType); 2] =
    [("TorqueFlags", FieldType::Flags(TorqueFlags::NAMES)), ("Controllers", Controllers::TYPE)];

fn layouts() -> impl Iterator<Item = &'static MessageLayout> {
    HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS)
}

/// A number as the document writes it, decimal or hexadecimal.
fn number(cell: &str) -> u32 {
    let parsed = match cell.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16),
        None => cell.parse(),
    };
    parsed.unwrap_or_else(|_| panic!("{cell:?} is no number"))
}

#[test]
fn every_message_has_its_table_of_bytes() {
    for layout in layouts() {
        let (name, body, frame) = (layout.name, layout.body_len, layout.frame_len());
        let section = section(&format!("### {name} ({:#04x})", layout.kind));
        let way = match layout.direction {
            Direction::HostToDrive => "Host to drive",
            Direction::DriveToHost => "Drive to host",
        };
        let plural = if body == 1 { "" } else { "s" };
        let facts = format!("{way}, body {body} byte{plural}, frame {frame} bytes. ");
        assert!(section.trim_start().starts_with(&facts), "{name} begins with {facts:?}: {section}");
        if layout.fields.is_empty() {
            assert!(!section.contains("| offset |"), "{name} has no fields: {section}");
            continue;
        }
        let rows = table(section, "offset");
        assert_eq!(rows.len(), layout.fields.len(), "fields of {name}");
        for (row, field) in rows.iter().zip(layout.fields) {
            let want =
                [field.offset.to_string(), field.len.to_string(), field.name.to_owned(), type_name(field)];
            assert_eq!(row[..4], want, "{name}");
            assert_eq!(row.len(), 7, "columns of {name}.{}", field.name);
            assert!(!row[6].is_empty(), "{name}.{} has a meaning", field.name);
            for values in values_of(field.ty) {
                assert!(row[4].contains(&format!("[{values}](#")), "{name}.{} is of {values}", field.name);
            }
        }
    }
}

/// The lists and the bits that a field's values are taken from.
fn values_of(ty: FieldType) -> Vec<&'static str> {
    match ty {
        FieldType::Enum(names) => {
            let known = LISTS.iter().find(|(_, list)| *list == names);
            vec![known.expect("every list is documented").0]
        }
        FieldType::Flags(_) => {
            let known = FLAGS.iter().find(|(_, flags)| *flags == ty);
            vec![known.expect("every set of bits is documented").0]
        }
        FieldType::Status { states, flags } => {
            [values_of(FieldType::Enum(states)), values_of(FieldType::Flags(flags))].concat()
        }
        FieldType::ParameterValue => vec!["ParameterType"],
        _ => Vec::new(),
    }
}

#[test]
fn no_message_is_described_that_is_not_there() {
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
        assert_eq!(row[..4], [kind, layout.name.into(), sender.into(), layout.frame_len().to_string()]);
    }
}

#[test]
fn every_type_of_a_field_is_explained_with_its_length() {
    let rows = table(section("## 3. Types of fields"), "type");
    let explained: BTreeSet<_> = rows.iter().map(|row| (row[0].as_str(), row[1].as_str())).collect();
    for (layout, field) in layouts().flat_map(|layout| layout.fields.iter().map(move |field| (layout, field)))
    {
        let (name, len) = (type_name(field), field.len.to_string());
        let wanted = if field.ty == FieldType::Text { ("text[n]", "n") } else { (&*name, &*len) };
        assert!(explained.contains(&wanted), "{}.{} is {wanted:?}", layout.name, field.name);
    }
}

#[test]
fn lists_of_values_are_closed_and_complete() {
    for (name, values) in LISTS {
        let rows = table(section(&format!("### {name}")), "byte");
        let have: Vec<_> = rows.iter().map(|row| (number(&row[0]), row[1].as_str())).collect();
        let want: Vec<_> = values.iter().map(|(byte, value)| (u32::from(*byte), *value)).collect();
        assert_eq!(have, want, "{name}");
    }
    for (name, ty) in FLAGS {
        let FieldType::Flags(bits) = ty else { panic!("{name} is a set of bits") };
        let rows = table(section(&format!("### {name}")), "mask");
        let have: Vec<_> = rows.iter().map(|row| (number(&row[0]), row[1].as_str())).collect();
        let want: Vec<_> = bits.iter().map(|(mask, bit)| (u32::from(*mask), *bit)).collect();
        assert_eq!(have, want, "{name}");
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
    ];
    assert_eq!(have, want);
}

#[test]
fn the_crc_is_the_one_that_frames_carry() {
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
fn the_frames_of_the_example_read_as_it_says() {
    let sheets = fences(section("## 13. A conversation, byte by byte"));
    assert!(sheets.len() > 10, "{} frames", sheets.len());
    for sheet in sheets {
        let (_, digits) = sheet.rsplit_once("frame: ").unwrap_or_else(|| panic!("no frame in {sheet}"));
        let byte = |digits| u8::from_str_radix(digits, 16).expect("two hexadecimal digits");
        let frame: Vec<u8> = digits.split_whitespace().map(byte).collect();
        let want = if sheet.contains("host -> drive") {
            Decoder::new().next::<HostMessage>(&mut &frame[..]).map(|it| it.map(|it| data_sheet(&it)))
        } else {
            Decoder::new().next::<DriveMessage>(&mut &frame[..]).map(|it| it.map(|it| data_sheet(&it)))
        };
        assert_eq!(want, Some(Ok(sheet.to_owned())));
    }
}
