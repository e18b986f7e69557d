//! A message as a data sheet: every field with its offset, type, value and bytes.

use std::fmt::Write;

use lashloop_protocol::field_value::FieldValue;
use lashloop_protocol::hex::Hex;
use lashloop_protocol::layout::{Direction, FieldLayout, FieldType, MessageLayout};
use lashloop_protocol::{Message, crc, frame};

use crate::examples::NUMBER;

/// The body in the frame of an example.
pub fn body_of<M: Message>(message: &M) -> Vec<u8> {
    numbered_body(NUMBER, message)
}

fn numbered_body<M: Message>(number: u8, message: &M) -> Vec<u8> {
    let frame = message.numbered_frame(number);
    let mut stuffed = frame[..frame.len() - 1].to_vec();
    frame::open(&mut stuffed).expect("an encoded frame is valid").to_vec()
}

/// The data sheet of an example.
pub fn data_sheet<M: Message>(message: &M) -> String {
    numbered_sheet(NUMBER, message)
}

/// The data sheet of a message with this number, from its layout and from the bytes of its frame. An optional field that is absent
/// has no row.
pub fn numbered_sheet<M: Message>(number: u8, message: &M) -> String {
    let (layout, frame) = (message.layout(), message.numbered_frame(number));
    let body = numbered_body(number, message);
    let mut sheet = heading(layout, body.len(), frame.len());
    row(&mut sheet, 0, "kind", "u8", &format!("{:#04x}", body[0]), &body[..1]);
    if layout.has_number() {
        row(&mut sheet, 1, "number", "u8", &number.to_string(), &body[1..2]);
    }
    for field in layout.fields {
        match field.value(&body).zip(field.bytes(&body)) {
            Some((value, bytes)) => {
                row(&mut sheet, field.offset, field.name, &type_name(field), &text_of(value), bytes);
            }
            None => assert!(field.optional, "{}.{} is a field of this body", layout.name, field.name),
        }
    }
    let crc = crc::checksum(&body);
    row(&mut sheet, body.len(), "crc", "crc32c", &format!("{crc:#010x}"), &crc.to_le_bytes());
    let _ = write!(sheet, "frame: {:#}", Hex(&frame));
    sheet
}

fn heading(layout: &MessageLayout, body: usize, frame: usize) -> String {
    let way = match layout.direction {
        Direction::HostToDrive => "host -> drive",
        Direction::DriveToHost => "drive -> host",
    };
    let (name, kind) = (layout.name, layout.kind);
    format!(
        "{name}, kind {kind:#04x}, {way}, body {body} bytes, frame {frame} bytes\n\
         offset  field                   type       value               bytes\n"
    )
}

fn row(sheet: &mut String, offset: usize, field: &str, ty: &str, value: &str, bytes: &[u8]) {
    let _ = writeln!(sheet, "{offset:>6}  {field:<22}  {ty:<9}  {value:<18}  {:#}", Hex(bytes));
}

fn text_of(value: FieldValue) -> String {
    match value {
        FieldValue::Parameter(value) => format!("{} {value}", value.ty().name().to_lowercase()),
        value => value.to_string(),
    }
}

/// Name of a field's type in the specification.
pub fn type_name(field: &FieldLayout) -> String {
    let bits = field.len * 8;
    match field.ty {
        FieldType::U8 | FieldType::U16 | FieldType::U32 => format!("u{bits}"),
        FieldType::I24 => "i24".to_owned(),
        FieldType::F32 => "f32".to_owned(),
        FieldType::F32Repeated => "f32[n]".to_owned(),
        FieldType::Enum(_) => "enum8".to_owned(),
        FieldType::Flags(_) => format!("flags{bits}"),
        FieldType::Status { .. } => "status8".to_owned(),
        FieldType::Text => format!("text[{}]", field.len),
        FieldType::ParameterValue => "value".to_owned(),
        FieldType::Version => "version".to_owned(),
    }
}

/// Length of the frames of a kind that this version sends, in bytes, in the notation of the specification.
pub fn frame_bytes_of(layout: &MessageLayout) -> String {
    let (shortest, longest) = (layout.shortest_body_len() + frame::OVERHEAD, layout.frame_len());
    if shortest == longest { longest.to_string() } else { format!("{shortest} to {longest}") }
}
