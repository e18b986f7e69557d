//! The fields of a message as the layout describes them.

use std::fmt;

use lashloop_protocol::enums::{ParameterValue, TorqueStatus, Version};
use lashloop_protocol::layout::{FieldLayout, FieldType};
use lashloop_protocol::wire::Wire;
use lashloop_protocol::{EncoderCounts, Message, frame};

use super::message::AnyMessage;

/// One field of a message that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Name, with the unit where there is one.
    pub name: &'static str,
    /// What it says.
    pub value: Value,
    /// Unit, where there is one.
    pub unit: Option<&'static str>,
}

/// The value of a field.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A whole number.
    Unsigned(u32),
    /// A whole number with a sign.
    Signed(i32),
    /// A real number.
    Real(f32),
    /// One of a closed list of names.
    Name(&'static str),
    /// One of a closed list of names, and the flags that are set beside it.
    Status(&'static str, Vec<String>),
    /// The flags that are set; one without a name is called by its bit.
    Flags(Vec<String>),
    /// A text.
    Text(String),
    /// The value of a parameter, with its type.
    Parameter(ParameterValue),
    /// The version of the firmware.
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

/// Units by the end of a field's name; the first that fits is right.
const UNITS: [(&str, &str); 6] = [
    ("_counts_per_rev", "counts per revolution"),
    ("_counts", "counts"),
    ("_tenths_us", "0.1 us"),
    ("_us", "us"),
    ("_nm", "N m"),
    ("_rad", "rad"),
];

/// The unit of a field, which is the end of its name.
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
    // A frame that was made a moment ago is whole.
    let Ok(body) = frame::open(stuffed) else { return Vec::new() };
    let field = |layout: &'static FieldLayout| {
        let bytes = body.get(layout.offset..layout.offset + layout.len)?;
        Some(Field { name: layout.name, value: value(&layout.ty, bytes)?, unit: unit(layout.name) })
    };
    message.layout().fields.iter().filter_map(field).collect()
}

/// `None` for bytes that are no value of this type, which a decoded message doesn't hold.
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
    fn units_are_those_the_layouts_speak_of() {
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
    fn a_flag_without_a_name_is_called_by_its_bit() {
        let names = lashloop_protocol::layout::FlagSet { name: "Controllers", flags: &[(2, "PD")] };
        let flags = value(&FieldType::Flags(names), &[0b10, 0b10]).unwrap();
        assert_eq!(flags.to_string(), "PD|bit 9");
    }
}
