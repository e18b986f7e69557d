//! From values to bytes and back: how each type of field lies on the wire, and the one place where bytes are checked.

use crate::layout::{FieldType, MessageLayout};

/// A type that occupies a fixed number of bytes in a message.
pub trait Wire: Copy {
    /// Number of bytes.
    const LEN: usize;
    /// How a stranger has to read them.
    const TYPE: FieldType;

    /// Writes the value to `out`, which is exactly [`Self::LEN`] bytes long.
    fn put(self, out: &mut [u8]);

    /// Reads the value from exactly [`Self::LEN`] bytes; `None` where they stand for no value of this type.
    fn get(bytes: &[u8]) -> Option<Self>;
}

/// One kind of message as a value that knows its layout.
pub trait Payload: Copy {
    /// The layout, as data.
    const LAYOUT: MessageLayout;

    /// Writes kind and fields to `body`, which is exactly `LAYOUT.body_len` bytes long.
    fn put(&self, body: &mut [u8]);

    /// Reads the fields from `body`.
    ///
    /// # Errors
    /// [`BodyError::Length`] and [`BodyError::Value`]; the kind byte has been looked at by the caller.
    fn get(body: &[u8]) -> Result<Self, BodyError>;
}

/// A body whose CRC was right but which is no message of this version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BodyError {
    /// No message of this direction has this kind byte.
    #[error(
        "kind {kind:#04x} is not a message of this direction in protocol version {}",
        crate::PROTOCOL_VERSION
    )]
    UnknownKind {
        /// The byte found.
        kind: u8,
    },
    /// The body is longer or shorter than its kind says.
    #[error("{name} takes {expected} bytes, got {found}")]
    Length {
        /// The message.
        name: &'static str,
        /// Length by its layout.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// A field holds bytes that stand for no value of its type.
    #[error("{name}.{field} holds bytes that are no value of its type")]
    Value {
        /// The message.
        name: &'static str,
        /// The field.
        field: &'static str,
    },
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
