//! The fields of a body, each through a site of its own: `message | field`.

use lashloop_protocol::layout::{FieldLayout, FieldType, MessageLayout};

use crate::mutation::{Sites, Width};

/// Sends every field of a body of this kind through its site.
pub fn through_sites(at: &Sites, layout: &MessageLayout, body: &mut Vec<u8>) {
    for field in layout.fields {
        if field.optional && field.bytes(body).is_none() {
            continue;
        }
        if matches!(field.ty, FieldType::F32Repeated) {
            let values = body[field.offset..].chunks(4).map(|bytes| Width::F32.read(bytes) as f32).collect();
            let values = at.list(layout.name, field.name, values);
            body.truncate(field.offset);
            body.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        } else {
            one(at, layout, field, body);
        }
    }
}

fn one(at: &Sites, layout: &MessageLayout, field: &FieldLayout, body: &mut [u8]) {
    let (site, part) = (layout.name, field.name);
    let range = field.offset..field.offset + field.len;
    match field.ty {
        FieldType::Enum(list) => {
            body[field.offset] = listed(at, (site, part), list.values, body[field.offset]);
        }
        FieldType::Status { states, flags } => {
            let byte = body[field.offset];
            let state = listed(at, (site, "state"), states.values, byte & 0x0f) & 0x0f;
            body[field.offset] = flags_of(at, site, flags.flags, byte & 0xf0) | state;
        }
        FieldType::Flags(set) => body[field.offset] = flags_of(at, site, set.flags, body[field.offset]),
        FieldType::Text => at.text(site, part, &mut body[range]),
        FieldType::ParameterValue => {
            let kinds = [(1, "U32"), (2, "F32")];
            let ty = listed(at, (site, type_of(field)), &kinds, body[field.offset]);
            body[field.offset] = ty;
            number(at, layout, field, if ty == 2 { Width::F32 } else { Width::U32 }, body);
        }
        FieldType::Version => {}
        FieldType::U8 => number(at, layout, field, Width::U8, body),
        FieldType::U16 => number(at, layout, field, Width::U16, body),
        FieldType::U32 => number(at, layout, field, Width::U32, body),
        FieldType::I24 => number(at, layout, field, Width::I24, body),
        FieldType::F32 => number(at, layout, field, Width::F32, body),
        FieldType::F32Repeated => unreachable!("the last field"),
    }
}

fn type_of(field: &FieldLayout) -> &'static str {
    match field.name {
        "default" => "type of default",
        "min" => "type of min",
        "max" => "type of max",
        _ => "type of value",
    }
}

/// A byte that no list names.
const UNNAMED: u8 = 77;

/// A byte of a list. A mutant may send 0 too, which no list has, and one without a name.
fn listed(
    at: &Sites,
    (site, part): (&'static str, &'static str),
    list: &[(u8, &'static str)],
    byte: u8,
) -> u8 {
    let mut bytes: [u8; 32] = [0; 32];
    for (place, (value, _)) in bytes[2..].iter_mut().zip(list) {
        *place = *value;
    }
    bytes[1] = UNNAMED;
    let bytes = &bytes[..list.len() + 2];
    if bytes.contains(&byte) { at.pick(site, part, byte, bytes) } else { byte }
}

fn flags_of(at: &Sites, site: &'static str, flags: &[(u8, &'static str)], byte: u8) -> u8 {
    flags.iter().fold(
        byte,
        |byte, (mask, name)| {
            if at.flag(site, name, byte & mask != 0) { byte | mask } else { byte & !mask }
        },
    )
}

/// A number. A mistaken drive takes that of the neighbouring field of the same type.
fn number(at: &Sites, layout: &MessageLayout, field: &FieldLayout, width: Width, body: &mut [u8]) {
    let skip = usize::from(field.ty == FieldType::ParameterValue);
    let bytes = |field: &FieldLayout| field.offset + skip..field.offset + field.len;
    let value = width.read(&body[bytes(field)]);
    let place = layout.fields.iter().position(|it| it == field).expect("a field of the message");
    let neighbour = |it: Option<&FieldLayout>| it.copied().filter(|it| it.ty == field.ty && !it.optional);
    let next = neighbour(layout.fields.get(place + 1));
    let other = next.or_else(|| neighbour(place.checked_sub(1).and_then(|it| layout.fields.get(it))));
    let other = other.map(|other| width.read(&body[bytes(&other)]));
    let value = at.number_or(layout.name, field.name, (value, width), other);
    width.write(value, &mut body[bytes(field)]);
}
