//! The layout of every message as data.
//!
//! The declaration that encodes and decodes a message also fills these tables. Data sheets, the C header, the specification's
//! tests and decoders in other languages are therefore derived from the code.

use crate::limits;

/// Which side sends a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the bench to the drive; kinds `0x01..=0x7f`.
    HostToDrive,
    /// From the drive to the bench; kinds `0x81..=0xff`.
    DriveToHost,
}

/// A closed list of values of one byte. Zero is in no list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValueList {
    /// Name of the list in the specification.
    pub name: &'static str,
    /// Every byte with its name, in ascending order.
    pub values: &'static [(u8, &'static str)],
}

impl ValueList {
    /// Name of the value with this byte; `None` if the list has no such value.
    #[must_use]
    pub fn name_of(&self, byte: u8) -> Option<&'static str> {
        self.values.iter().find(|(value, _)| *value == byte).map(|(_, name)| *name)
    }
}

/// A set of flags, one bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlagSet {
    /// Name of the set in the specification.
    pub name: &'static str,
    /// Every mask with its name, in ascending order.
    pub flags: &'static [(u16, &'static str)],
}

impl FlagSet {
    /// Name of the flag with this mask; `None` if the set has no such flag.
    #[must_use]
    pub fn name_of(&self, mask: u16) -> Option<&'static str> {
        self.flags.iter().find(|(flag, _)| *flag == mask).map(|(_, name)| *name)
    }
}

/// Type of a field: how to read its bytes. Numbers are little endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldType {
    /// Unsigned, 1 byte.
    U8,
    /// Unsigned, 2 bytes.
    U16,
    /// Unsigned, 4 bytes.
    U32,
    /// Two's complement, 3 bytes.
    I24,
    /// IEEE 754 binary32, 4 bytes.
    F32,
    /// One byte of a closed list; any other byte is rejected.
    Enum(ValueList),
    /// One bit each, 2 bytes. Bits without a name are kept: a newer drive may offer more.
    Flags(FlagSet),
    /// One byte: a value in the low four bits, flags above it. A value or a flag without a name is rejected.
    Status {
        /// Values of the low four bits.
        states: ValueList,
        /// Flags, with masks of the whole byte.
        flags: FlagSet,
    },
    /// UTF-8, padded with zeros to the length of the field.
    Text,
    /// One byte of `ParameterType`, then 4 bytes of that type.
    ParameterValue,
    /// Major, minor, patch: one byte each.
    Version,
}

/// One field of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldLayout {
    /// Name, with the unit as its suffix.
    pub name: &'static str,
    /// Type.
    pub ty: FieldType,
    /// Offset of the first byte; the kind byte has offset 0.
    pub offset: usize,
    /// Length, in bytes.
    pub len: usize,
    /// Documentation of the field.
    pub meaning: &'static str,
}

/// Units by the suffix of a field's name; the first match applies.
pub const UNITS: [(&str, &str); 6] = [
    ("_counts_per_rev", "counts per revolution"),
    ("_counts", "counts"),
    ("_tenths_us", "0.1 us"),
    ("_us", "us"),
    ("_nm", "N m"),
    ("_rad", "rad"),
];

impl FieldLayout {
    /// Unit of the field, from the suffix of its name; `None` for a pure number and for anything but a number.
    #[must_use]
    pub fn unit(&self) -> Option<&'static str> {
        UNITS.iter().find(|(suffix, _)| self.name.ends_with(suffix)).map(|(_, unit)| *unit)
    }

    /// The bytes of the field in a body; `None` if the body is too short.
    #[must_use]
    pub fn bytes<'a>(&self, body: &'a [u8]) -> Option<&'a [u8]> {
        body.get(self.offset..self.offset + self.len)
    }
}

/// One kind of message: all that is needed to read its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageLayout {
    /// Name of the message.
    pub name: &'static str,
    /// The byte at offset 0.
    pub kind: u8,
    /// Sender.
    pub direction: Direction,
    /// Fields in the order of their bytes.
    pub fields: &'static [FieldLayout],
    /// Length of the body: the kind byte and all fields, without CRC and framing.
    pub body_len: usize,
    /// Documentation of the message.
    pub meaning: &'static str,
}

impl MessageLayout {
    /// Length of the whole frame, in bytes.
    #[must_use]
    pub const fn frame_len(&self) -> usize {
        self.body_len + limits::OVERHEAD
    }
}
