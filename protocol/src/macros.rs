//! Declarations that yield a value type, its bytes and its layout together.

/// An open list of values of one byte: a newer peer may send values without a name. Zero is never a value, so that a cleared byte
/// is rejected.
macro_rules! wire_list {
    (
        $(#[$meta:meta])*
        pub enum $name:ident {
            $( $(#[doc = $doc:expr])+ $variant:ident = $value:literal, )+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $name {
            $( $(#[doc = $doc])+ $variant, )+
            /// A value that this version of the contract has no name for.
            Unknown($crate::enums::UnknownByte),
        }

        impl $name {
            /// Every value with a name, in the order of its byte.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The list as data, with the identifiers of the specification.
            pub const LIST: $crate::layout::ValueList = $crate::layout::ValueList {
                name: stringify!($name),
                values: &[$(($value, stringify!($variant))),+],
            };

            /// Name of the value, `unknown` for one without a name.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => stringify!($variant),)+
                    Self::Unknown(_) => "unknown",
                }
            }

            /// Whether this version of the contract has a name for the value.
            #[must_use]
            pub const fn is_named(self) -> bool {
                !matches!(self, Self::Unknown(_))
            }

            /// The byte on the wire.
            #[inline]
            #[must_use]
            pub const fn byte(self) -> u8 {
                match self {
                    $(Self::$variant => $value,)+
                    Self::Unknown(byte) => byte.get(),
                }
            }

            /// The value with this byte; `None` for 0 only.
            #[inline]
            #[must_use]
            pub const fn from_byte(byte: u8) -> Option<Self> {
                match byte {
                    0 => None,
                    $($value => Some(Self::$variant),)+
                    _ => Some(Self::Unknown($crate::enums::UnknownByte(byte))),
                }
            }
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, out: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match self {
                    Self::Unknown(byte) => write!(out, "unknown {}", byte.get()),
                    named => out.pad(named.name()),
                }
            }
        }

        impl $crate::wire::Wire for $name {
            const LEN: usize = 1;
            const TYPE: $crate::layout::FieldType = $crate::layout::FieldType::Enum(Self::LIST);

            #[inline]
            fn put(self, out: &mut [u8]) {
                out[0] = self.byte();
            }

            #[inline]
            fn get(bytes: &[u8]) -> Option<Self> {
                Self::from_byte(bytes[0])
            }
        }
    };
}

/// The flags of a `bitflags` type as data: `SET`.
macro_rules! flag_set {
    ($name:ident) => {
        impl $name {
            /// The set as data.
            pub const SET: $crate::layout::FlagSet = $crate::layout::FlagSet {
                name: stringify!($name),
                flags: &{
                    const FLAGS: &[bitflags::Flag<$name>] = <$name as bitflags::Flags>::FLAGS;
                    let mut flags = [(0, ""); FLAGS.len()];
                    let mut at = 0;
                    while at < FLAGS.len() {
                        flags[at] = (FLAGS[at].value().bits(), FLAGS[at].name());
                        at += 1;
                    }
                    flags
                },
            };
        }
    };
}

/// A `bitflags` type as a field of one byte. Bits without a name are kept: a newer peer may set more.
macro_rules! wire_flags {
    ($name:ident) => {
        impl $crate::wire::Wire for $name {
            const LEN: usize = 1;
            const TYPE: $crate::layout::FieldType = $crate::layout::FieldType::Flags(Self::SET);

            #[inline]
            fn put(self, out: &mut [u8]) {
                out[0] = self.bits();
            }

            #[inline]
            fn get(bytes: &[u8]) -> Option<Self> {
                Some(Self::from_bits_retain(*bytes.first()?))
            }
        }
    };
}

/// All messages of one direction: the kinds, the type of any of them, and the one that is sent in every control period.
macro_rules! messages {
    (
        $(#[$meta:meta])* pub enum $name:ident: $direction:ident, in every period $periodic:ident;
        $( $(#[doc = $doc:expr])+ $kind:literal $variant:ident $fields:tt )+
    ) => {
        $(payload! { $(#[doc = $doc])+ $kind $direction $variant $fields })+
        direction! { $(#[$meta])* pub enum $name { $($variant,)+ } in every period $periodic }
    };
}

/// One kind of message: its value type, its bytes and its layout.
///
/// Offsets follow from the order and the lengths of the fields; no other code computes them.
macro_rules! payload {
    (
        $(#[doc = $doc:expr])+
        $kind:literal $direction:ident $name:ident {
            $( $(#[doc = $field_doc:expr])+ $field:ident: $ty:ty, )*
        }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name { $( $(#[doc = $field_doc])+ pub $field: $ty, )* }

        #[allow(unused_mut, unused_variables, unused_assignments, reason = "nothing follows the last field")]
        impl $crate::wire::Payload for $name {
            const LAYOUT: $crate::layout::MessageLayout = {
                const FIELDS: &[$crate::layout::FieldLayout] = &{
                    let mut end = $crate::layout::fields_at($kind);
                    [$({
                        let offset = end;
                        let len = <$ty as $crate::wire::Wire>::LEN;
                        end += len;
                        $crate::layout::FieldLayout {
                            name: stringify!($field),
                            ty: <$ty as $crate::wire::Wire>::TYPE,
                            offset,
                            len,
                            optional: <$ty as $crate::wire::Wire>::OPTIONAL,
                            meaning: concat!($($field_doc),+),
                        }
                    }),*]
                };
                $crate::layout::MessageLayout {
                    name: stringify!($name),
                    kind: $kind,
                    direction: $crate::layout::Direction::$direction,
                    fields: FIELDS,
                    body_len: $crate::layout::fields_at($kind) $(+ <$ty as $crate::wire::Wire>::LEN)*,
                    element_len: $crate::layout::last_element_len(FIELDS, &[$(<$ty as $crate::wire::Wire>::ELEMENT_LEN),*]),
                    meaning: concat!($($doc),+),
                }
            };

            #[inline]
            fn body_len(&self) -> usize {
                let fields_at = const { $crate::layout::fields_at($kind) };
                fields_at $(+ $crate::wire::Wire::byte_len(self.$field))*
            }

            #[inline]
            fn put(&self, number: u8, body: &mut [u8]) {
                body[0] = $kind;
                if const { $crate::layout::has_number($kind) } {
                    body[1] = number;
                }
                let mut at = const { $crate::layout::fields_at($kind) };
                $({
                    let end = at + $crate::wire::Wire::byte_len(self.$field);
                    $crate::wire::Wire::put(self.$field, &mut body[at..end]);
                    at = end;
                })*
            }

            #[inline]
            fn get(body: &[u8]) -> Result<Self, $crate::wire::BodyError> {
                $crate::wire::check_len::<Self>(body.len())?;
                let mut at = const { $crate::layout::fields_at($kind) };
                $(
                    let bytes = $crate::wire::field_bytes::<$ty>(body, at);
                    let $field = <$ty as $crate::wire::Wire>::get(bytes).ok_or(
                        $crate::wire::BodyError::Value { name: stringify!($name), field: stringify!($field) },
                    )?;
                    at += bytes.len();
                )*
                Ok(Self { $($field),* })
            }
        }

        const _: () = assert!(
            <$name as $crate::wire::Payload>::LAYOUT.body_len <= $crate::limits::MAX_BODY,
            concat!(stringify!($name), " does not fit into a frame")
        );
    };
}

/// All messages of one direction as one type, and the one that is sent in every control period.
macro_rules! direction {
    ($(#[$meta:meta])* pub enum $name:ident { $($variant:ident,)+ } in every period $periodic:ident) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum $name { $(
            #[doc = concat!("See [`", stringify!($variant), "`](struct@", stringify!($variant), ").")]
            $variant($variant),
        )+ }

        $(impl From<$variant> for $name {
            fn from(payload: $variant) -> Self {
                Self::$variant(payload)
            }
        }

        impl TryFrom<&$name> for $variant {
            type Error = ();

            fn try_from(message: &$name) -> Result<Self, ()> {
                if let $name::$variant(payload) = message { Ok(*payload) } else { Err(()) }
            }
        })+

        impl $crate::message::Message for $name {
            const LAYOUTS: &'static [$crate::layout::MessageLayout] =
                &[$(<$variant as $crate::wire::Payload>::LAYOUT),+];

            #[inline]
            fn decode_body(body: &[u8]) -> Result<$crate::message::Numbered<Self>, $crate::wire::BodyError> {
                use $crate::wire::Payload;
                let (kind, number) = $crate::wire::kind_and_number(body);
                let numbered = |message| $crate::message::Numbered { number, message };
                $(if kind == $variant::LAYOUT.kind {
                    return $variant::get(body).map(Self::$variant).map(numbered);
                })+
                Err($crate::wire::BodyError::of_kind(kind, number, Self::LAYOUTS[0].direction))
            }

            #[cfg(feature = "fast-path")]
            #[inline(always)]
            fn split_off_periodic(input: &[u8]) -> Option<(Self, &[u8])> {
                let (payload, rest) = $crate::fast_path::split_off::<$periodic>(input)?;
                Some((Self::$periodic(payload), rest))
            }

            fn layout(&self) -> &'static $crate::layout::MessageLayout {
                match self { $(Self::$variant(_) => const { &<$variant as $crate::wire::Payload>::LAYOUT },)+ }
            }

            #[cfg_attr(feature = "fast-path", inline(always))]
            #[cfg_attr(not(feature = "fast-path"), inline)]
            fn write_numbered<'buffer>(
                &self,
                number: u8,
                buffer: &'buffer mut [u8; $crate::limits::MAX_FRAME],
            ) -> &'buffer [u8] {
                #[cfg(feature = "fast-path")]
                if let Self::$periodic(payload) = self {
                    return $crate::fast_path::write(payload, buffer);
                }
                self.write_frame_of_any_kind(number, buffer)
            }
        }

        impl $name {
            #[cfg_attr(feature = "fast-path", inline(never))]
            #[cfg_attr(not(feature = "fast-path"), inline)]
            pub(crate) fn write_frame_of_any_kind<'buffer>(
                &self,
                number: u8,
                buffer: &'buffer mut [u8; $crate::limits::MAX_FRAME],
            ) -> &'buffer [u8] {
                match self { $(Self::$variant(payload) => $crate::frame::write(payload, number, buffer),)+ }
            }
        }
    };
}
