//! Reading a section: each key is declared once, with its unit, default and range.
//!
//! A call such as `plant.number("dead_zone_rad", 0.16, positive(3.2))` declares the key and reads it; the end of the key is
//! its unit. Errors are
//! collected: a faulty key yields a stand-in, reading goes on, and the scenario is rejected in the end with all of its
//! errors. The stand-in of a number is NaN, so that comparisons between keys don't report the same error again.
//!
//! | module | is |
//! |---|---|
//! | `section` | a section, the sections in it, and missing and unknown keys |
//! | `values` | numbers, texts and choices |
//! | `free` | lists of texts, and free tables |
//! | `schema` | the keys a section has, and what an unknown key was meant to be |

mod free;
mod schema;
mod section;
mod values;

pub(super) use section::{Section, read_document};
