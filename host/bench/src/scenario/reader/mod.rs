//! Reading a section: each key is declared once, with its unit, default and range.
//!
//! A call such as `plant.doc("Half gap").number("dead_zone_rad", 0.16, positive(3.2))` declares the key and reads it; the end
//! of the key is its unit. The declarations are also the source of the page and the JSON Schema of scenarios. Errors are
//! collected: a faulty key yields a stand-in, reading goes on, and the scenario is rejected in the end with all of its
//! errors. The stand-in of a number is NaN, so that comparisons between keys don't report the same error again.
//!
//! | module | is |
//! |---|---|
//! | `section` | a section, the sections in it, and missing and unknown keys |
//! | `values` | numbers, texts and choices |
//! | `schema` | the keys a section has, and what an unknown key was meant to be |

mod schema;
mod section;
mod values;

pub use section::Section;
pub use values::Scalar;

pub(super) use schema::{KnownKey, SectionKeys};
pub(super) use section::read_document;
