//! Arbitrary bodies, generated from the layouts, so that a new kind of message is covered without a change here.

use lashloop_protocol::layout::{FieldType, MessageLayout};
use lashloop_protocol::{MAX_BODY, Message, cobs, crc};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

/// The body of any message of one direction, with valid values.
pub fn body_of<M: Message>() -> impl Strategy<Value = Vec<u8>> {
    select(M::LAYOUTS).prop_flat_map(|layout| of_layout(&layout))
}

/// The body of any message of one direction, with any bytes in its fields.
pub fn wild_body_of<M: Message>() -> impl Strategy<Value = Vec<u8>> {
    select(M::LAYOUTS).prop_flat_map(|layout| {
        vec(any::<u8>(), layout.shortest_body_len()..=MAX_BODY).prop_map(move |mut body| {
            body[0] = layout.kind;
            body
        })
    })
}

/// The frame around any body, with a correct CRC.
pub fn frame_around(body: &[u8]) -> Vec<u8> {
    let mut frame = [&[0], body, &crc::checksum(body).to_le_bytes()].concat();
    cobs::stuff(&mut frame);
    frame.push(0);
    frame
}

fn of_layout(layout: &MessageLayout) -> BoxedStrategy<Vec<u8>> {
    let head = vec(any::<u8>(), usize::from(layout.has_number()));
    let head = head.prop_map({
        let kind = layout.kind;
        move |number| [vec![kind], number].concat()
    });
    layout.fields.iter().fold(head.boxed(), |body, field| {
        let value = value_of(&field.ty, field.len);
        let value = if field.optional { prop_oneof![Just(vec![]), value].boxed() } else { value };
        (body, value).prop_map(|(body, field)| [body, field].concat()).boxed()
    })
}

fn value_of(ty: &FieldType, len: usize) -> BoxedStrategy<Vec<u8>> {
    match *ty {
        FieldType::Enum(_) => (1..=u8::MAX).prop_map(|byte| vec![byte]).boxed(),
        FieldType::Flags(_) => any::<u8>().prop_map(|bits| vec![bits]).boxed(),
        FieldType::Status { .. } => {
            (1..=0x0f_u8, any::<u8>()).prop_map(|(state, flags)| vec![state | flags & 0xf0]).boxed()
        }
        FieldType::F32Repeated => (1..=len / 4).prop_flat_map(|count| edgy(4 * count)).boxed(),
        FieldType::Text => text(len).boxed(),
        FieldType::ParameterValue => {
            (1..=4_u8, edgy(4)).prop_map(|(ty, value)| [vec![ty], value].concat()).boxed()
        }
        FieldType::U8
        | FieldType::U16
        | FieldType::U32
        | FieldType::I24
        | FieldType::F32
        | FieldType::Version => edgy(len).boxed(),
    }
}

/// Any bytes, with the edge cases of stuffing and numbers more frequent.
fn edgy(len: usize) -> impl Strategy<Value = Vec<u8>> {
    let byte = prop_oneof![3 => any::<u8>(), 2 => Just(0_u8), 1 => select(&[1_u8, 0x7f, 0x80, 0xff][..])];
    vec(byte, len)
}

/// Any text that fits, padded.
fn text(len: usize) -> impl Strategy<Value = Vec<u8>> {
    let character = any::<char>().prop_filter("a zero is padding", |&character| character != '\0');
    vec(character, 0..=len).prop_map(move |characters| {
        let mut text = String::new();
        for character in characters {
            if text.len() + character.len_utf8() <= len {
                text.push(character);
            }
        }
        let mut bytes = text.into_bytes();
        bytes.resize(len, 0);
        bytes
    })
}
