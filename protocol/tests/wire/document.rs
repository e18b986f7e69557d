//! `docs/protocol.md` and its annexes agree with the code: every table of bytes, every list of values, the CRC, the limits and
//! the bytes of the example. The package `tests` verifies the behaviour of the drive.

use std::collections::BTreeSet;

use ::crc::CRC_32_ISCSI;
use lashloop_protocol::enums::{FLAG_SETS, VALUE_LISTS};
use lashloop_protocol::layout::{Direction, FieldLayout, FieldType, MessageLayout};
use lashloop_protocol::limits::{
    DELIMITER, FAULT_NAMES, FLAG_NAMES, KIND_NAMES, MAX_LAWS, MAX_PARAMETERS, MAX_SIGNALS,
    MAX_TELEMETRY_VALUES, OUTCOME_NAMES, OVERHEAD, STATE_NAMES,
};
use lashloop_protocol::{
    Decoder, DriveMessage, HostMessage, MAX_BODY, MAX_FRAME, MINOR_VERSION, Message, PROTOCOL_VERSION, crc,
    parameter_names,
};

use crate::data_sheet::{frame_bytes_of, numbered_sheet, type_name};
use crate::digits::bytes_of;
use crate::markdown::{PROTOCOL, fences, section, sheets, table};

/// The page without its annexes.
const PAGE: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/protocol.md"));

/// Longest page, in bytes: what all drives and hosts need fits into an hour.
const LONGEST_PAGE: usize = 45_000;

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
fn the_page_is_at_most_45_kb_long() {
    assert!(PAGE.len() <= LONGEST_PAGE, "docs/protocol.md has {} bytes", PAGE.len());
}

#[test]
fn every_message_has_a_table_of_its_bytes() {
    for layout in layouts().filter(|layout| !layout.fields.is_empty()) {
        let name = layout.name;
        let rows = table(section(&format!("### {name} ({:#04x})", layout.kind)), "offset");
        assert_eq!(rows.len(), layout.fields.len(), "fields of {name}");
        for (row, field) in rows.iter().zip(layout.fields) {
            let want = [field.offset.to_string(), length_of(field), field.name.to_owned(), type_name(field)];
            assert_eq!(row[..4], want, "{name}");
            let [_, _, _, _, meaning] = &row[..] else { panic!("columns of {name}.{}", field.name) };
            assert_eq!(meaning.contains("optional"), field.optional, "{name}.{}", field.name);
            for values in values_of(field.ty) {
                assert!(meaning.contains(values), "{name}.{} is of {values}", field.name);
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
    let headings: BTreeSet<_> =
        layouts().map(|layout| format!("### {} ({:#04x})", layout.name, layout.kind)).collect();
    for line in PROTOCOL.lines().filter(|line| line.starts_with("### ") && line.contains("(0x")) {
        assert!(headings.contains(line), "{line}");
    }
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
    assert!(PAGE.starts_with(&format!("# The wire protocol, version {PROTOCOL_VERSION}\n")));
    let rows = table(section("## 2. Frames"), "limit");
    let have: Vec<_> = rows.iter().map(|row| (row[0].as_str(), number(&row[1]) as usize)).collect();
    let want = [
        ("PROTOCOL_VERSION", usize::from(PROTOCOL_VERSION)),
        ("MINOR_VERSION", usize::from(MINOR_VERSION)),
        ("MAX_FRAME", MAX_FRAME),
        ("MAX_BODY", MAX_BODY),
        ("OVERHEAD", OVERHEAD),
        ("DELIMITER", usize::from(DELIMITER)),
        ("MAX_LAWS", MAX_LAWS),
        ("MAX_SIGNALS", MAX_SIGNALS),
        ("MAX_PARAMETERS", MAX_PARAMETERS),
        ("MAX_TELEMETRY_VALUES", MAX_TELEMETRY_VALUES),
    ];
    assert_eq!(have, want);
}

#[test]
fn lists_with_names_are_those_of_the_code() {
    let rows = table(section("## 10. Laws, signals and choices"), "parameter");
    let have: Vec<_> = rows.iter().map(|row| (number(&row[0]), row[1].as_str())).collect();
    let want = [
        (FAULT_NAMES, "FAULT_NAMES"),
        (OUTCOME_NAMES, "OUTCOME_NAMES"),
        (STATE_NAMES, "STATE_NAMES"),
        (FLAG_NAMES, "FLAG_NAMES"),
        (KIND_NAMES, "KIND_NAMES"),
    ];
    assert_eq!(have, want.map(|(list, name)| (u32::from(list), name)));
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
    let count = format!("`signal_count` 0 and `parameter_count` {}.", required.len());
    let words: Vec<_> = section("## 10. Laws, signals and choices").split_whitespace().collect();
    assert!(words.join(" ").contains(&count), "the minimal drive has {count:?}");
}

#[test]
fn the_crc_is_that_of_the_code() {
    let rows = table(section("### CRC"), "");
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
    assert!(fences(section("## CRC in C"))[0].contains(&reflected), "the loop in C divides by {reflected}");
}

/// The data sheet of the message in a frame.
fn sheet_of<M: Message>(frame: &[u8]) -> String {
    match Decoder::new().next::<M>(&mut &frame[..]) {
        Some(Ok(it)) => numbered_sheet(it.number, &it.message),
        other => panic!("{:?}", other.map(|it| it.map(|_| ()))),
    }
}

#[test]
fn the_frames_of_the_example_decode_as_described() {
    let sheets = sheets();
    assert!(sheets.len() > 10, "{} frames", sheets.len());
    for sheet in sheets {
        let (_, digits) = sheet.rsplit_once("frame: ").expect("a data sheet ends with its frame");
        let frame = bytes_of(digits);
        let from_host = sheet.contains("host -> drive");
        let want = if from_host { sheet_of::<HostMessage>(&frame) } else { sheet_of::<DriveMessage>(&frame) };
        assert_eq!(want, sheet);
    }
}
