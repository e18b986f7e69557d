//! Prints a message as a data sheet: every field with its offset, type, value and bytes.

use std::fmt::Write;

use lashloop_protocol::layout::{Direction, FieldLayout, FieldType, MessageLayout};
use lashloop_protocol::{Message, cobs};

/// The data sheet of one message, from its layout and from the bytes of its frame.
pub fn data_sheet<M: Message>(message: &M) -> String {
    let frame = message.frame();
    let mut stuffed = frame[..frame.len() - 1].to_vec();
    let unstuffed = cobs::unstuff(&mut stuffed).expect("a frame of ours is stuffed as COBS asks");
    let (body, crc) = unstuffed.split_at(unstuffed.len() - 4);
    let layout = M::LAYOUTS.iter().find(|layout| layout.kind == body[0]).expect("every message has a layout");
    assert_eq!((layout.body_len, layout.frame_len()), (body.len(), frame.len()), "{}", layout.name);

    let mut sheet = heading(layout);
    row(&mut sheet, 0, "kind", "u8", &format!("{:#04x}", body[0]), &body[..1]);
    for field in layout.fields {
        let bytes = &body[field.offset..field.offset + field.len];
        row(&mut sheet, field.offset, field.name, &type_name(field), &value(field.ty, bytes), bytes);
    }
    row(&mut sheet, body.len(), "crc", "crc32c", &format!("{:#010x}", u32_of(crc)), crc);
    let _ = write!(sheet, "frame: {}", hex(&frame));
    sheet
}

fn heading(layout: &MessageLayout) -> String {
    let way = match layout.direction {
        Direction::HostToDrive => "host -> drive",
        Direction::DriveToHost => "drive -> host",
    };
    let (name, kind, body, frame) = (layout.name, layout.kind, layout.body_len, layout.frame_len());
    format!(
        "{name}, kind {kind:#04x}, {way}, body {body} bytes, frame {frame} bytes\n\
         offset  field                   type       value               bytes\n"
    )
}

fn row(sheet: &mut String, offset: usize, field: &str, ty: &str, value: &str, bytes: &[u8]) {
    let _ = writeln!(sheet, "{offset:>6}  {field:<22}  {ty:<9}  {value:<18}  {}", hex(bytes));
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ")
}

fn u32_of(bytes: &[u8]) -> u32 {
    u32::from_le_bytes(bytes.try_into().unwrap())
}

/// What a data sheet calls the type of a field.
pub fn type_name(field: &FieldLayout) -> String {
    let bits = field.len * 8;
    match field.ty {
        FieldType::U8 | FieldType::U16 | FieldType::U32 => format!("u{bits}"),
        FieldType::I24 => "i24".to_owned(),
        FieldType::F32 => "f32".to_owned(),
        FieldType::Enum(_) => "enum8".to_owned(),
        FieldType::Flags(_) => format!("flags{bits}"),
        FieldType::Status { .. } => "status8".to_owned(),
        FieldType::Text => format!("text[{}]", field.len),
        FieldType::ParameterValue => "value".to_owned(),
        FieldType::Version => "version".to_owned(),
    }
}

fn i24_of(bytes: &[u8]) -> i32 {
    i32::from_le_bytes([0, bytes[0], bytes[1], bytes[2]]) >> 8
}

fn name_of(names: &[(u8, &'static str)], byte: u8) -> &'static str {
    names.iter().find(|(named, _)| *named == byte).expect("a named byte").1
}

fn names_of(names: &[(u16, &'static str)], bits: u16) -> Vec<&'static str> {
    names.iter().filter(|(mask, _)| bits & mask != 0).map(|(_, name)| *name).collect()
}

fn value(ty: FieldType, bytes: &[u8]) -> String {
    match ty {
        FieldType::U8 => bytes[0].to_string(),
        FieldType::U16 => u16::from_le_bytes([bytes[0], bytes[1]]).to_string(),
        FieldType::U32 => u32_of(bytes).to_string(),
        FieldType::I24 => i24_of(bytes).to_string(),
        FieldType::F32 => f32::from_bits(u32_of(bytes)).to_string(),
        FieldType::Enum(names) => name_of(names, bytes[0]).to_owned(),
        FieldType::Flags(names) => {
            let bits = bytes.iter().rev().fold(0, |bits, &byte| bits << 8 | u16::from(byte));
            names_of(names, bits).join("|")
        }
        FieldType::Status { states, flags } => {
            let state = [name_of(states, bytes[0] & 0x0f)];
            [&state[..], &names_of(flags, bytes[0].into())].concat().join("|")
        }
        FieldType::Text => {
            format!("{:?}", String::from_utf8(bytes.to_vec()).unwrap().trim_end_matches('\0'))
        }
        FieldType::ParameterValue => match bytes[0] {
            1 => format!("u32 {}", u32_of(&bytes[1..])),
            _ => format!("f32 {}", f32::from_bits(u32_of(&bytes[1..]))),
        },
        FieldType::Version => format!("{}.{}.{}", bytes[0], bytes[1], bytes[2]),
    }
}
