//! Prints a message as a data sheet: every field with its offset, type, value and bytes.

use std::fmt::Write;

use lashloop_protocol::layout::{Direction, FieldType, MessageLayout};
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
        let (ty, value) = render(&field.ty, bytes);
        row(&mut sheet, field.offset, field.name, &ty, &value, bytes);
    }
    let value = u32::from_le_bytes(crc.try_into().unwrap());
    row(&mut sheet, body.len(), "crc", "crc32c", &format!("{value:#010x}"), crc);
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

fn render(ty: &FieldType, bytes: &[u8]) -> (String, String) {
    let (name, value) = match *ty {
        FieldType::U8 => ("u8", bytes[0].to_string()),
        FieldType::U16 => ("u16", u16::from_le_bytes([bytes[0], bytes[1]]).to_string()),
        FieldType::U32 => ("u32", u32_of(bytes).to_string()),
        FieldType::I32 => ("i32", u32_of(bytes).cast_signed().to_string()),
        FieldType::F32 => ("f32", f32::from_bits(u32_of(bytes)).to_string()),
        FieldType::Enum(names) => {
            let (_, name) = names.iter().find(|(byte, _)| *byte == bytes[0]).expect("a named byte");
            ("enum8", (*name).to_owned())
        }
        FieldType::Flags(names) => {
            let bits = bytes.iter().rev().fold(0, |bits, &byte| bits << 8 | u16::from(byte));
            let set: Vec<_> =
                names.iter().filter(|(mask, _)| bits & mask != 0).map(|(_, name)| *name).collect();
            (if bytes.len() == 1 { "flags8" } else { "flags16" }, set.join("|"))
        }
        FieldType::Text => {
            let text = String::from_utf8(bytes.to_vec()).unwrap();
            return (format!("text[{}]", bytes.len()), format!("{:?}", text.trim_end_matches('\0')));
        }
        FieldType::ParameterValue => match bytes[0] {
            1 => ("value", format!("u32 {}", u32_of(&bytes[1..]))),
            _ => ("value", format!("f32 {}", f32::from_bits(u32_of(&bytes[1..])))),
        },
        FieldType::Version => ("version", format!("{}.{}.{}", bytes[0], bytes[1], bytes[2])),
    };
    (name.to_owned(), value)
}
