//! Sections and choices as types: one declaration for type, reader and documents.

/// Declares a section, a choice, or a choice whose names have keys of their own. The doc lines of a key are its meaning on the
/// page too, so they omit unit, range and default, which the [`Field`](crate::scenario::declare::Field) after the `=` has.
///
/// | declaration | entry | yields |
/// |---|---|---|
/// | `struct Name` | `key: Type = field`, or `field as "key": Type = field` | the struct, its [`Settings`](crate::scenario::declare::Settings) |
/// | `impl Name` | the same | [`Settings`](crate::scenario::declare::Settings) of a struct that is declared elsewhere |
/// | `struct Name with(name: Type)` | the same; fields may use `name` | the struct, functions `declare` and `read` that take `name` |
/// | `enum Name` | `"name" => Variant`, or `default "name" => Variant` | the enum, [`Named`](crate::scenario::declare::Named), `Serialize` as its name |
/// | `enum Name` | `"name" => Variant { entries }` | the enum, [`Variants`](crate::scenario::declare::Variants) |
#[macro_export]
macro_rules! settings {
    ($(#[$attribute:meta])* $visible:vis struct $name:ident $(with($with:ident: $context:ty))? {
        $($(#[doc = $doc:literal])+ $(#[serde($($serde:tt)+)])* $shown:vis $key:ident $(as $word:literal)?: $type:ty = $field:expr,)+
    }) => {
        $(#[$attribute])*
        $visible struct $name {
            $($(#[doc = $doc])+ $(#[serde($($serde)+)])* $shown $key: $type,)+
        }

        $crate::settings! {
            @read $name ($($with: $context)?) $([($key $($word)?) (concat!($($doc),+)) ($type) ($field)])+
        }
    };
    ($(#[doc = $what:literal])* impl $name:ident {
        $($(#[doc = $doc:literal])+ $key:ident: $type:ty = $field:expr,)+
    }) => {
        $crate::settings! { @read $name () $([($key) (concat!($($doc),+)) ($type) ($field)])+ }
    };
    (@read $name:ident () $([($($key:tt)+) ($doc:expr) ($type:ty) ($field:expr)])+) => {
        impl $crate::scenario::declare::Settings for $name {
            fn declare(keys: &mut $crate::scenario::key::Keys) {
                $($crate::scenario::declare::declare::<$type>(&$field, $crate::settings!(@key $($key)+), $doc, keys);)+
            }

            fn read(section: &mut $crate::scenario::Section<'_>) -> Self {
                $crate::settings!(@new section $([($($key)+) ($field)])+)
            }
        }
    };
    (@read $name:ident ($with:ident: $context:ty) $([($($key:tt)+) ($doc:expr) ($type:ty) ($field:expr)])+) => {
        impl $name {
            fn declare(keys: &mut $crate::scenario::key::Keys, $with: $context) {
                $($crate::scenario::declare::declare::<$type>(&$field, $crate::settings!(@key $($key)+), $doc, keys);)+
            }

            fn read(section: &mut $crate::scenario::Section<'_>, $with: $context) -> Self {
                $crate::settings!(@new section $([($($key)+) ($field)])+)
            }
        }
    };
    (@new $section:ident $([($key:ident $($word:literal)?) ($field:expr)])+) => {
        Self {
            $($key: $crate::scenario::declare::Field::read(&$field, $crate::settings!(@key $key $($word)?), $section),)+
        }
    };
    (@key $key:ident) => { stringify!($key) };
    (@key $key:ident $word:literal) => { $word };

    ($(#[$attribute:meta])* $visible:vis enum $name:ident {
        $($(#[doc = $doc:literal])+ $($default:ident)? $word:literal => $variant:ident,)+
    }) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $visible enum $name {
            $($(#[doc = $doc])+ $(#[$default])? $variant,)+
        }

        impl $crate::scenario::declare::Named for $name {
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            fn choice(self) -> $crate::scenario::key::Choice {
                let (name, doc) = match self {
                    $(Self::$variant => ($word, concat!($($doc),+)),)+
                };
                $crate::scenario::key::Choice { name, doc: doc.trim_ascii() }
            }
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str($crate::scenario::declare::Named::choice(*self).name)
            }
        }
    };
    ($(#[$attribute:meta])* $visible:vis enum $name:ident {
        $($(#[doc = $doc:literal])+ $word:literal => $variant:ident {
            $($(#[doc = $key_doc:literal])+ $key:ident: $type:ty = $field:expr,)*
        },)+
    }) => {
        $(#[$attribute])*
        $visible enum $name {
            $($(#[doc = $doc])+ #[serde(rename = $word)] $variant { $($(#[doc = $key_doc])+ $key: $type,)* },)+
        }

        impl $crate::scenario::declare::Variants for $name {
            fn choices() -> Vec<$crate::scenario::key::Choice> {
                vec![$($crate::scenario::key::Choice { name: $word, doc: concat!($($doc),+).trim_ascii() }),+]
            }

            fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $word,)+
                }
            }

            fn declare(name: &str, keys: &mut $crate::scenario::key::Keys) -> bool {
                // A choice whose names have no keys adds none.
                let _ = &keys;
                match name {
                    $($word => {
                        $($crate::scenario::declare::declare::<$type>(&$field, stringify!($key), concat!($($key_doc),+), keys);)*
                        true
                    })+
                    _ => false,
                }
            }

            fn read(name: &str, section: &mut $crate::scenario::Section<'_>) -> Option<Self> {
                let _ = &section;
                match name {
                    $($word => Some(Self::$variant {
                        $($key: $crate::scenario::declare::Field::read(&$field, stringify!($key), section),)*
                    }),)+
                    _ => None,
                }
            }
        }
    };
}
