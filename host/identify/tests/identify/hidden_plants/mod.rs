//! How often the intervals contain the truth: hidden plants drawn at random, and the count over them.

mod hidden;
mod tally;

pub use hidden::{Errors, HiddenPlant};
pub use tally::{Coverage, Shown};
