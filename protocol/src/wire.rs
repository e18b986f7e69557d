//! How each type of field, and a body made of fields, is written to bytes and read back. All checks of a body are here.

use crate::layout::{FieldType, MessageLayout};
use crate::limits;

/// A type that occupies a fixed number of bytes in a message.
pub trait Wire: Copy {
    /// Length, in bytes.
    const LEN: usize;
    /// Type of the field, for its layout.
    const TYPE: FieldType;

    /// Writes the value to `out`, which is exactly [`Self::LEN`] bytes long.
    fn put(self, out: &mut [u8]);

    /// Reads the value from exactly [`Self::LEN`] bytes; `None` if the bytes are no value of this type.
    fn get(bytes: &[u8]) -> Option<Self>;
}

/// One kind of message as a value with a layout.
pub trait Payload: Copy {
    /// Layout of the message.
    const LAYOUT: MessageLayout;

    /// Writes kind and fields to `body`, which is exactly `LAYOUT.body_len` bytes long.
    fn put(&self, body: &mut [u8]);

    /// Reads the fields from `body`. The caller has checked the kind byte.
    ///
    /// # Errors
    /// [`BodyError::Length`] and [`BodyError::Value`].
    fn get(body: &[u8]) -> Result<Self, BodyError>;
}

/// A body with a correct CRC that is no message of this protocol version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BodyError {
    /// No message of this direction has this kind byte.
    #[error(
        "kind {kind:#04x} is not a message of this direction in protocol version {}",
        limits::PROTOCOL_VERSION
    )]
    UnknownKind {
        /// Kind byte received.
        kind: u8,
    },
    /// The length of the body is not that of its kind.
    #[error("{name} takes {expected} bytes, got {found}")]
    Length {
        /// Name of the message.
        name: &'static str,
        /// Length of the layout, in bytes.
        expected: usize,
        /// Length received, in bytes.
        found: usize,
    },
    /// A field holds bytes that are no value of its type.
    #[error("{name}.{field} holds bytes that are no value of its type")]
    Value {
        /// Name of the message.
        name: &'static str,
        /// Name of the field.
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
