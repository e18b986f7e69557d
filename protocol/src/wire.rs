//! How each type of field, and a body made of fields, is written to bytes and read back. All checks of a body are here.

use crate::layout::{Direction, FieldType, MessageLayout, has_number, is_body_len};
use crate::limits;

/// Type of a field: a fixed number of bytes or, in the last field of a message, a number of equal elements.
pub trait Wire: Copy {
    /// Length of the longest value, in bytes.
    const LEN: usize;
    /// Length of an element, in bytes, if the number of elements differs between values; else every value is [`Self::LEN`]
    /// bytes long.
    const ELEMENT_LEN: Option<usize> = None;
    /// Whether a body may end before the field, so that no bytes are a value.
    const OPTIONAL: bool = false;
    /// Type of the field, for its layout.
    const TYPE: FieldType;

    /// Length of this value, in bytes.
    #[inline]
    fn byte_len(self) -> usize {
        Self::LEN
    }

    /// Writes the value to `out`, which is exactly [`Self::byte_len`] bytes long.
    fn put(self, out: &mut [u8]);

    /// Reads the value from bytes of a length that the type allows; `None` if the bytes aren't a value of this type.
    fn get(bytes: &[u8]) -> Option<Self>;
}

/// One kind of message as a value with a layout.
pub trait Payload: Copy {
    /// Layout of the message.
    const LAYOUT: MessageLayout;

    /// Length of the body of this message, in bytes.
    fn body_len(&self) -> usize;

    /// Writes kind, number and fields to `body`, which is exactly [`Self::body_len`] bytes long. A kind without a number ignores
    /// `number`.
    fn put(&self, number: u8, body: &mut [u8]);

    /// Reads the fields from `body`. The caller has checked the kind byte.
    ///
    /// # Errors
    /// [`BodyError::Length`], [`BodyError::Elements`] and [`BodyError::Value`].
    fn get(body: &[u8]) -> Result<Self, BodyError>;
}

/// A body with a correct CRC that isn't a message of this protocol version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BodyError {
    /// A newer peer sent a message that this version doesn't know. The receiver skips it; it isn't refused.
    #[error(
        "kind {kind:#04x} is not known to protocol version {}.{}",
        limits::PROTOCOL_VERSION,
        limits::MINOR_VERSION
    )]
    UnknownKind {
        /// Kind byte received.
        kind: u8,
        /// Number of the request or answer; 0 if the body has none.
        number: u8,
    },
    /// The other side sends this kind, as on a line with an echo, or no side does.
    #[error("kind {kind:#04x} is not a kind of this direction")]
    OtherDirection {
        /// Kind byte received.
        kind: u8,
    },
    /// The body is shorter than any of its kind.
    #[error("{name} takes at least {shortest} bytes, got {found}")]
    Length {
        /// Name of the message.
        name: &'static str,
        /// Length of the shortest body, in bytes.
        shortest: usize,
        /// Length received, in bytes.
        found: usize,
    },
    /// The length of the body is none of those that its kind, whose last field repeats, may have.
    #[error("{name} takes at most {longest} bytes, in steps of {step} bytes, got {found}")]
    Elements {
        /// Name of the message.
        name: &'static str,
        /// Longest length, in bytes.
        longest: usize,
        /// Length of an element, in bytes.
        step: usize,
        /// Length received, in bytes.
        found: usize,
    },
    /// A field holds bytes that aren't a value of its type.
    #[error("{name}.{field} holds bytes that aren't a value of its type")]
    Value {
        /// Name of the message.
        name: &'static str,
        /// Name of the field.
        field: &'static str,
    },
}

impl BodyError {
    /// The error of a kind byte that the receiver of messages of `direction` doesn't know.
    pub(crate) const fn of_kind(kind: u8, number: u8, direction: Direction) -> Self {
        let sent_in_direction = match direction {
            Direction::HostToDrive => 0x00 < kind && kind < 0x80,
            Direction::DriveToHost => 0x80 < kind,
        };
        if sent_in_direction { Self::UnknownKind { kind, number } } else { Self::OtherDirection { kind } }
    }
}

/// The kind byte of a body, and its number; 0 for what the body doesn't have.
#[inline]
pub(crate) fn kind_and_number(body: &[u8]) -> (u8, u8) {
    match *body {
        [kind, number, ..] if has_number(kind) => (kind, number),
        [kind, ..] => (kind, 0),
        [] => (0, 0),
    }
}

/// The bytes of a field that begins at `at` in a body whose length is checked; none if the body ends before or inside an optional
/// field.
#[inline]
pub(crate) fn field_bytes<W: Wire>(body: &[u8], at: usize) -> &[u8] {
    let end = match W::ELEMENT_LEN {
        None => at + W::LEN,
        Some(_) => body.len(),
    };
    if W::OPTIONAL { body.get(at..end).unwrap_or_default() } else { &body[at..end] }
}

/// Checks the length of a body, in bytes.
///
/// # Errors
/// [`BodyError::Length`] and [`BodyError::Elements`].
#[inline]
pub(crate) fn check_len<P: Payload>(found: usize) -> Result<(), BodyError> {
    let (longest, shortest) = const { (P::LAYOUT.body_len, P::LAYOUT.shortest_body_len()) };
    let name = const { P::LAYOUT.name };
    let element_len = const { P::LAYOUT.element_len };
    if is_body_len(found, shortest, longest, element_len) {
        return Ok(());
    }
    Err(match element_len {
        None => BodyError::Length { name, shortest, found },
        Some(step) => BodyError::Elements { name, longest, step, found },
    })
}

macro_rules! wire_number {
    ($($ty:ident $layout:ident),*) => { $(
        impl Wire for $ty {
            const LEN: usize = size_of::<$ty>();
            const TYPE: FieldType = FieldType::$layout;

            #[inline]
            fn put(self, out: &mut [u8]) {
                out.copy_from_slice(&self.to_le_bytes());
            }

            #[inline]
            fn get(bytes: &[u8]) -> Option<Self> {
                Some(Self::from_le_bytes(bytes.try_into().ok()?))
            }
        }
    )* };
}

wire_number!(u8 U8, u16 U16, u32 U32, f32 F32);

/// Four bytes or, at the end of a body, none.
impl Wire for Option<u32> {
    const LEN: usize = <u32 as Wire>::LEN;
    const OPTIONAL: bool = true;
    const TYPE: FieldType = <u32 as Wire>::TYPE;

    #[inline]
    fn byte_len(self) -> usize {
        self.map_or(0, Wire::byte_len)
    }

    #[inline]
    fn put(self, out: &mut [u8]) {
        if let Some(value) = self {
            value.put(out);
        }
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        Some(u32::get(bytes))
    }
}
