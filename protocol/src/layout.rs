//! The layout of every message as data.
//!
//! The same declaration that encodes and decodes a message also fills these tables, so data sheets, documents and
//! decoders in other languages are printed from what the code does rather than from what somebody remembered.

/// Which side sends a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the bench to the drive; kinds `0x01..=0x7f`.
    HostToDrive,
    /// From the drive to the bench; kinds `0x81..=0xff`.
    DriveToHost,
}

/// How the bytes of a field are to be read. Numbers are little endian.
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
    /// One byte out of a closed list of names; any other byte is refused.
    Enum(&'static [(u8, &'static str)]),
    /// One bit each. The list holds mask and name; a set bit without a name is refused, except in `controllers`, where a
    /// newer drive may offer more.
    Flags(&'static [(u16, &'static str)]),
    /// One byte: a value out of a closed list of names in its low four bits, and bits with names above them.
    Status {
        /// Values of the low four bits; any other is refused.
        states: &'static [(u8, &'static str)],
        /// Masks of the whole byte, as in [`FieldType::Flags`]; a set bit without a name is refused.
        flags: &'static [(u16, &'static str)],
    },
    /// UTF-8, padded with zeros to the field's length.
    Text,
    /// A [`ParameterType`](crate::enums::ParameterType) byte, then 4 bytes of that type.
    ParameterValue,
    /// Major, minor, patch: one byte each.
    Version,
}

/// One field of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldLayout {
    /// Name, with the unit where there is one.
    pub name: &'static str,
    /// How to read the bytes.
    pub ty: FieldType,
    /// First byte, counted from the kind byte at 0.
    pub offset: usize,
    /// Number of bytes.
    pub len: usize,
    /// What it means.
    pub meaning: &'static str,
}

/// One kind of message: everything a stranger needs to read its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageLayout {
    /// Name of the message.
    pub name: &'static str,
    /// The byte at offset 0.
    pub kind: u8,
    /// Who sends it.
    pub direction: Direction,
    /// Fields in the order of their bytes.
    pub fields: &'static [FieldLayout],
    /// Length of the body: the kind byte and all fields, without CRC and framing.
    pub body_len: usize,
    /// What it says.
    pub meaning: &'static str,
}

impl MessageLayout {
    /// Length of the whole frame on the wire, in bytes.
    #[must_use]
    pub const fn frame_len(&self) -> usize {
        self.body_len + crate::frame::OVERHEAD
    }
}
