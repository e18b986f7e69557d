//! The layout of every message as data.
//!
//! The declaration that encodes and decodes a message also fills these tables. Data sheets, the C header, the specification's
//! tests and decoders in other languages are therefore derived from the code.

use core::fmt;

use crate::limits;

/// Which side sends a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the bench to the drive; kinds `0x01..=0x7f`.
    HostToDrive,
    /// From the drive to the bench; kinds `0x81..=0xff`.
    DriveToHost,
}

/// Whether messages of this kind carry the number of a request after the kind byte.
///
/// Requests and answers do. What is sent in every control period, and what a drive sends unasked, does not: kinds
/// `0x10..=0x1f` and `0x90..=0x9f`. The rule holds for kinds that this version doesn't know, too.
#[inline]
#[must_use]
pub const fn has_number(kind: u8) -> bool {
    kind & 0x70 != 0x10
}

/// Offset of the first field of a kind: after the kind byte and, if the kind has one, the number.
#[inline]
#[must_use]
pub const fn fields_at(kind: u8) -> usize {
    if has_number(kind) { 2 } else { 1 }
}

/// An open list of values of one byte. Zero is in no list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValueList {
    /// Name of the list in the specification.
    pub name: &'static str,
    /// Every byte that this version names, with its name, in ascending order.
    pub values: &'static [(u8, &'static str)],
}

/// A value of a list: its byte, and its name if this version has one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListValue {
    /// Byte on the wire; never 0.
    pub byte: u8,
    /// Name in the specification; `None` for a value that a newer peer added.
    pub name: Option<&'static str>,
}

impl fmt::Display for ListValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name {
            Some(name) => out.pad(name),
            None => write!(out, "unknown {}", self.byte),
        }
    }
}

impl ValueList {
    /// The value with this byte; `None` for 0 only.
    #[must_use]
    pub fn value(&self, byte: u8) -> Option<ListValue> {
        (byte != 0).then(|| ListValue { byte, name: self.name_of(byte) })
    }

    /// Name of the value with this byte; `None` if this version has no name for it.
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
    pub flags: &'static [(u8, &'static str)],
}

impl FlagSet {
    /// Name of the flag with this mask; `None` if the set has no such flag.
    #[must_use]
    pub fn name_of(&self, mask: u8) -> Option<&'static str> {
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
    /// IEEE 754 binary32, 4 bytes each, up to the end of the body; at least one.
    F32Repeated,
    /// One byte of an open list; only 0 is rejected.
    Enum(ValueList),
    /// One bit each, 1 byte. Bits without a name are kept: a newer drive may set more.
    Flags(FlagSet),
    /// One byte: a value in the low four bits, flags above it. Only a value of 0 is rejected.
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
    /// Length, in bytes; of a repeated field the longest.
    pub len: usize,
    /// Whether a body may end before this field, which then has no value.
    pub optional: bool,
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

    /// The bytes of the field in a body; `None` if the body ends before or inside the field.
    #[must_use]
    pub fn bytes<'a>(&self, body: &'a [u8]) -> Option<&'a [u8]> {
        let end = match self.ty {
            FieldType::F32Repeated => body.len(),
            _ => self.offset + self.len,
        };
        body.get(self.offset..end)
    }
}

/// Length of an element of the last field, from those of all fields.
pub(crate) const fn last_element_len(
    fields: &[FieldLayout],
    element_lens: &[Option<usize>],
) -> Option<usize> {
    let mut last = None;
    let mut at = 0;
    while at < fields.len() {
        assert!(last.is_none(), "only the last field of a message may repeat");
        assert!(
            !fields[at].optional || at + 1 == fields.len(),
            "only the last field of a message may be absent"
        );
        last = element_lens[at];
        at += 1;
    }
    last
}

/// Whether a body may have this length; all lengths in bytes. A newer minor version may have added fields, unless the last field
/// repeats to the end of the body.
pub(crate) const fn is_body_len(
    len: usize,
    shortest: usize,
    longest: usize,
    element_len: Option<usize>,
) -> bool {
    match element_len {
        None => shortest <= len,
        Some(step) => shortest <= len && len <= longest && (len - shortest).is_multiple_of(step),
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
    /// Length of the longest body that this version sends, in bytes: the kind byte, the number and all fields, without CRC and
    /// framing.
    pub body_len: usize,
    /// Length of an element of the last field, in bytes, if that field repeats to the end of the body, at least once.
    pub element_len: Option<usize>,
    /// Documentation of the message.
    pub meaning: &'static str,
}

impl MessageLayout {
    /// Length of the longest frame, in bytes.
    #[must_use]
    pub const fn frame_len(&self) -> usize {
        self.body_len + limits::OVERHEAD
    }

    /// Whether the number of a request follows the kind byte.
    #[must_use]
    pub const fn has_number(&self) -> bool {
        has_number(self.kind)
    }

    /// Length of the shortest body, in bytes.
    #[must_use]
    pub const fn shortest_body_len(&self) -> usize {
        match (self.element_len, self.fields.last()) {
            (Some(element_len), Some(last)) => last.offset + element_len,
            (None, Some(last)) if last.optional => last.offset,
            _ => self.body_len,
        }
    }

    /// Whether a receiver accepts a body of this kind with this length, in bytes.
    #[must_use]
    pub const fn takes(&self, body_len: usize) -> bool {
        is_body_len(body_len, self.shortest_body_len(), self.body_len, self.element_len)
    }

    /// Length of the body with `elements` elements in its last field, in bytes; `None` unless the last field repeats and takes
    /// that many.
    #[must_use]
    pub const fn body_len_of(&self, elements: usize) -> Option<usize> {
        match self.element_len {
            Some(element_len) if elements > 0 => {
                let len = self.shortest_body_len() + (elements - 1) * element_len;
                if len <= self.body_len { Some(len) } else { None }
            }
            _ => None,
        }
    }

    /// Length of the frame with `elements` elements in its last field, in bytes; `None` as for [`Self::body_len_of`].
    #[must_use]
    pub const fn frame_len_of(&self, elements: usize) -> Option<usize> {
        match self.body_len_of(elements) {
            Some(len) => Some(len + limits::OVERHEAD),
            None => None,
        }
    }
}
