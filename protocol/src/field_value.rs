//! The value of any field, read from a body by the field's layout: the one reader behind data sheets, decoders and tests.

use core::fmt;

use crate::counts::EncoderCounts;
use crate::enums::{ParameterValue, TorqueStatus, Version};
use crate::layout::{FieldLayout, FieldType, FlagSet, ListValue};
use crate::telemetry_values::TelemetryValues;
use crate::wire::Wire;

/// Value of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldValue<'a> {
    /// Unsigned integer of 1, 2 or 4 bytes.
    Unsigned(u32),
    /// Encoder counts.
    Signed(i32),
    /// Real number, NaN and infinities included.
    Real(f32),
    /// Real numbers of a repeated field.
    Reals(TelemetryValues),
    /// Value of a list.
    Name(ListValue),
    /// Flags that are set.
    Flags(SetFlags),
    /// Value of a list, and the flags that are set in the same byte.
    Status(ListValue, SetFlags),
    /// Text without its padding.
    Text(&'a str),
    /// Value of a parameter, with its type.
    Parameter(ParameterValue),
    /// Version of the firmware.
    Version(Version),
}

/// Flags that are set in a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetFlags {
    set: FlagSet,
    bits: u8,
}

/// A flag that is set: its name, or the number of its bit where the set has no name for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetFlag {
    /// Flag of this protocol version.
    Named(&'static str),
    /// Number of a bit without a name, from 0.
    Bit(u32),
}

impl SetFlags {
    /// The flags that are set, in ascending order of their bits.
    pub fn iter(self) -> impl Iterator<Item = SetFlag> {
        (0..u8::BITS)
            .filter(move |bit| self.bits >> bit & 1 == 1)
            .map(move |bit| self.set.name_of(1 << bit).map_or(SetFlag::Bit(bit), SetFlag::Named))
    }
}

impl fmt::Display for SetFlag {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Named(name) => out.write_str(name),
            Self::Bit(bit) => write!(out, "bit {bit}"),
        }
    }
}

/// Names separated by `|`, or `none`.
impl fmt::Display for SetFlags {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.bits == 0 {
            return out.write_str("none");
        }
        for (at, flag) in self.iter().enumerate() {
            let separator = if at > 0 { "|" } else { "" };
            write!(out, "{separator}{flag}")?;
        }
        Ok(())
    }
}

impl fmt::Display for FieldValue<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsigned(value) => value.fmt(out),
            Self::Signed(value) => value.fmt(out),
            Self::Real(value) => value.fmt(out),
            Self::Reals(values) => {
                for (at, value) in values.as_slice().iter().enumerate() {
                    let separator = if at > 0 { " " } else { "" };
                    write!(out, "{separator}{value}")?;
                }
                Ok(())
            }
            Self::Name(value) => value.fmt(out),
            Self::Flags(flags) => flags.fmt(out),
            Self::Status(state, flags) if flags.bits == 0 => state.fmt(out),
            Self::Status(state, flags) => write!(out, "{state}|{flags}"),
            Self::Text(text) => write!(out, "{text:?}"),
            Self::Parameter(value) => write!(out, "{value} ({})", value.ty()),
            Self::Version(version) => version.fmt(out),
        }
    }
}

impl FieldLayout {
    /// The value of the field in a body; `None` if the body ends before or inside the field or the bytes aren't a value of its type.
    #[must_use]
    pub fn value<'a>(&self, body: &'a [u8]) -> Option<FieldValue<'a>> {
        self.ty.value(self.bytes(body)?)
    }
}

impl FieldType {
    /// The value that `bytes` hold; `None` if they aren't a value of this type.
    #[must_use]
    pub fn value(self, bytes: &[u8]) -> Option<FieldValue<'_>> {
        Some(match self {
            Self::U8 | Self::U16 | Self::U32 => FieldValue::Unsigned(unsigned(bytes)),
            Self::I24 => FieldValue::Signed(<EncoderCounts as Wire>::get(bytes)?.get()),
            Self::F32 => FieldValue::Real(f32::get(bytes)?),
            Self::F32Repeated => FieldValue::Reals(TelemetryValues::get(bytes)?),
            Self::Enum(list) => FieldValue::Name(list.value(*bytes.first()?)?),
            Self::Flags(set) => FieldValue::Flags(SetFlags { set, bits: *bytes.first()? }),
            Self::Status { states, flags } => {
                let byte = *bytes.first()?;
                let bits = byte & !TorqueStatus::STATE_MASK;
                let state = states.value(byte & TorqueStatus::STATE_MASK)?;
                FieldValue::Status(state, SetFlags { set: flags, bits })
            }
            Self::Text => FieldValue::Text(core::str::from_utf8(bytes).ok()?.trim_end_matches('\0')),
            Self::ParameterValue => FieldValue::Parameter(ParameterValue::get(bytes)?),
            Self::Version => FieldValue::Version(Version::get(bytes)?),
        })
    }
}

fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}

#[cfg(test)]
mod tests {
    use std::format;
    use std::string::ToString;

    use super::*;
    use crate::layout::UNITS;
    use crate::message::{DriveMessage, HostMessage, Message};

    #[test]
    fn a_flag_without_a_name_is_shown_by_its_bit() {
        let set = FlagSet { name: "ParameterFlags", flags: &[(2, "CHOICES")] };
        let value = FieldType::Flags(set).value(&[0b1000_0010]).expect("any bits are flags");
        assert_eq!(value.to_string(), "CHOICES|bit 7");
    }

    #[test]
    fn units_in_names_are_those_of_the_documentation() {
        let mut with_unit = 0;
        for field in HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS).flat_map(|layout| layout.fields)
        {
            match field.unit() {
                Some(unit) => {
                    with_unit += 1;
                    assert!(field.meaning.contains(&format!("in {unit}")), "{} in {unit}", field.name);
                }
                None => {
                    let documented =
                        UNITS.iter().find(|(_, unit)| field.meaning.contains(&format!(", in {unit}")));
                    assert_eq!(documented, None, "{}", field.name);
                }
            }
        }
        assert!(with_unit >= 8, "{with_unit} fields with a unit");
    }
}
