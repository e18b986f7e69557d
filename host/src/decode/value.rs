//! The fields of a message, read by its layout. Text and JSON both format these values.

use std::fmt;

use lashloop_protocol::enums::{ParameterValue, TorqueStatus, Version};
use lashloop_protocol::layout::{FieldLayout, FieldType};
use lashloop_protocol::wire::Wire;
use lashloop_protocol::{EncoderCounts, Message, frame};

use super::message::AnyMessage;

#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// With the unit as its ending, if any.
    pub name: &'static str,
    pub value: Value,
    pub unit: Option<&'static str>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Unsigned(u32),
    Signed(i32),
    Real(f32),
    /// A value of an enumeration.
    Name(&'static str),
    /// A value of an enumeration and the flags in the same byte.
    Status(&'static str, Vec<String>),
    /// The flags that are set; an unnamed one is named by its bit.
    Flags(Vec<String>),
    Text(String),
    Parameter(ParameterValue),
    Version(Version),
}

impl fmt::Display for Value {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsigned(value) => value.fmt(out),
            Self::Signed(value) => value.fmt(out),
            Self::Real(value) => value.fmt(out),
            Self::Name(name) => name.fmt(out),
            Self::Status(name, flags) if flags.is_empty() => name.fmt(out),
            Self::Status(name, flags) => write!(out, "{name}|{}", flags.join("|")),
            Self::Flags(names) if names.is_empty() => write!(out, "none"),
            Self::Flags(names) => names.join("|").fmt(out),
            Self::Text(text) => write!(out, "{text:?}"),
            Self::Parameter(value) => write!(out, "{value} ({:?})", value.ty()),
            Self::Version(version) => version.fmt(out),
        }
    }
}

/// Units by the ending of a field's name; the first match applies.
const UNITS: [(&str, &str); 6] = [
    ("_counts_per_rev", "counts per revolution"),
    ("_counts", "counts"),
    ("_tenths_us", "0.1 us"),
    ("_us", "us"),
    ("_nm", "N m"),
    ("_rad", "rad"),
];

/// The unit of a field, by the ending of its name.
#[must_use]
pub fn unit(name: &str) -> Option<&'static str> {
    UNITS.iter().find(|(ending, _)| name.ends_with(ending)).map(|(_, unit)| *unit)
}

/// The fields of a message, in the order of their bytes.
pub(super) fn fields(message: &AnyMessage) -> Vec<Field> {
    let whole = message.frame();
    let mut stuffed = [0; frame::MAX_FRAME];
    let stuffed = &mut stuffed[..whole.len() - 1];
    stuffed.copy_from_slice(&whole[..whole.len() - 1]);
    // This frame was just encoded, so it is good.
    let Ok(body) = frame::open(stuffed) else { return Vec::new() };
    let field = |layout: &'static FieldLayout| {
        let bytes = body.get(layout.offset..layout.offset + layout.len)?;
        Some(Field { name: layout.name, value: value(&layout.ty, bytes)?, unit: unit(layout.name) })
    };
    message.layout().fields.iter().filter_map(field).collect()
}

/// `None` for bytes that are no value of this type. A decoded message has none such.
fn value(ty: &FieldType, bytes: &[u8]) -> Option<Value> {
    let unsigned = || bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte));
    Some(match ty {
        FieldType::U8 | FieldType::U16 | FieldType::U32 => Value::Unsigned(unsigned()),
        FieldType::I24 => Value::Signed(<EncoderCounts as Wire>::get(bytes)?.get()),
        FieldType::F32 => Value::Real(f32::from_bits(unsigned())),
        FieldType::Enum(names) => Value::Name(name(names.values, unsigned())?),
        FieldType::Flags(names) => Value::Flags(set_flags(names.flags, unsigned())),
        FieldType::Status { states, flags } => {
            let low = u32::from(TorqueStatus::STATE_MASK);
            Value::Status(name(states.values, unsigned() & low)?, set_flags(flags.flags, unsigned() & !low))
        }
        FieldType::Text => Value::Text(std::str::from_utf8(bytes).ok()?.trim_end_matches('\0').to_owned()),
        FieldType::ParameterValue => Value::Parameter(ParameterValue::get(bytes)?),
        FieldType::Version => Value::Version(Version::get(bytes)?),
    })
}

fn name(names: &[(u8, &'static str)], value: u32) -> Option<&'static str> {
    names.iter().find(|(byte, _)| u32::from(*byte) == value).map(|(_, name)| *name)
}

fn set_flags(names: &[(u16, &str)], value: u32) -> Vec<String> {
    let bits = (0..u16::BITS).map(|bit| 1 << bit).filter(|bit| value & u32::from(*bit) != 0);
    let named = |bit: u16| match names.iter().find(|(mask, _)| *mask == bit) {
        Some((_, name)) => (*name).to_owned(),
        None => format!("bit {}", bit.trailing_zeros()),
    };
    bits.map(named).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_match_the_layouts() {
        let mut with_unit = 0;
        for field in AnyMessage::LAYOUTS.iter().flat_map(|layout| layout.fields) {
            let meaning = field.meaning.trim();
            match unit(field.name) {
                Some(unit) => {
                    with_unit += 1;
                    assert!(meaning.contains(&format!("in {unit}")), "{} in {unit}: {meaning}", field.name);
                }
                None => {
                    let spoken = UNITS.iter().find(|(_, unit)| meaning.contains(&format!(", in {unit}")));
                    assert_eq!(spoken, None, "{}: {meaning}", field.name);
                }
            }
        }
        assert!(with_unit >= 14, "{with_unit} fields with a unit");
    }

    #[test]
    fn unnamed_flag_is_named_by_its_bit() {
        let names = lashloop_protocol::layout::FlagSet { name: "Controllers", flags: &[(2, "PD")] };
        let flags = value(&FieldType::Flags(names), &[0b10, 0b10]).unwrap();
        assert_eq!(flags.to_string(), "PD|bit 9");
    }
}
