//! Keys as values: the declaration of a section is its type, its reader and its documents.
//!
//! An entry such as `dead_zone_rad: f64 = number(positive(3.2)).or(0.16)` in [`settings!`](crate::settings) declares a key: the end
//! of its name is the unit, its doc line the meaning. A reader reports all errors of a file: a faulty key yields a stand-in,
//! and the file is rejected in the end.
//!
//! | module | is |
//! |---|---|
//! | `settings` | the macro |
//! | `field` | a key, a section, a list of sections; what the macro implements |
//! | `single` | numbers, texts and choices, also those whose names have keys of their own |
//! | `named` | types whose values have names |

mod field;
mod named;
mod settings;
mod single;

pub use field::{Field, Map, Settings, Variants, by, flat, plain, section, section_of, sections, skipped};
pub use named::Named;
pub use single::{
    Optional, Scalar, Single, any_text, choice, choices, integer, number, scalars, tagged, text, texts,
};

pub(super) use field::field;
pub(super) use single::{name_of, placed_texts, values};
