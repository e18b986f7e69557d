//! Reading a section: its table, its place in the document, and what is wrong with it.
//!
//! | module | is |
//! |---|---|
//! | `section` | a section, the sections in it, and missing keys |
//! | `unknown` | what an unknown key was meant to be |

mod section;
mod unknown;

pub use section::Section;

pub(super) use section::{Number, read_document};
