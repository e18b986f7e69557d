//! Sections and choices as types: one declaration for type, reader and documents.

/// Declares a section, a choice, or a choice whose names have keys of their own. The doc lines of a key are its meaning on the
/// page too, so they omit unit, range and default, which the [`Field`](crate::scenario::declare::Field) after the `=` has.
///
/// | declaration | entry | yields |
/// |---|---|---|
/// | `struct Name` | `key: Type = field`, or `field as "key": Type = field` | the struct, its [`Settings`](crate::scenario::declare::Settings) |
/// | `impl Name` | `key = field` | [`Settings`](crate::scenario::declare::Settings) of a struct that is declared elsewhere |
/// | `struct Name with(name: Type)` | the same; fields may use `name` | the struct, a function `read` that takes `name` |
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
            @read $name ($($with: $context)?) $([($key $($word)?) (concat!($($doc),+)) ($field)])+
        }
    };
    ($(#[doc = $what:literal])* impl $name:ident {
        $($(#[doc = $doc:literal])+ $key:ident = $field:expr,)+
    }) => {
        $crate::settings! { @read $name () $([($key) (concat!($($doc),+)) ($field)])+ }
    };
    (@read $name:ident () $($entry:tt)+) => {
        impl $crate::scenario::declare::Settings for $name {
            fn read(section: &mut $crate::scenario::Section<'_>) -> Self {
                $crate::settings!(@new section $($entry)+)
            }
        }
    };
    (@read $name:ident ($with:ident: $context:ty) $($entry:tt)+) => {
        impl $name {
            fn read(section: &mut $crate::scenario::Section<'_>, $with: $context) -> Self {
                $crate::settings!(@new section $($entry)+)
            }
        }
    };
    (@new $section:ident $([($key:ident $($word:literal)?) ($doc:expr) ($field:expr)])+) => {
        Self {
            $($key: $crate::settings!(@field $section, $crate::settings!(@key $key $($word)?), $doc, $field),)+
        }
    };
    (@field $section:ident, $name:expr, $doc:expr, $field:expr) => {
        $crate::scenario::declare::Field::read(&$field, $name, $doc.trim_ascii(), $section)
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

            fn read(name: &str, section: &mut $crate::scenario::Section<'_>) -> Option<Self> {
                // A choice whose names have no keys reads none.
                let _ = &section;
                match name {
                    $($word => Some(Self::$variant {
                        $($key: $crate::settings!(@field section, stringify!($key), concat!($($key_doc),+), $field),)*
                    }),)+
                    _ => None,
                }
            }
        }
    };
}
