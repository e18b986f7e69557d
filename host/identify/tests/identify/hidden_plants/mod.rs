//! How often the intervals contain the truth: hidden plants drawn at random, and the count over them.

pub mod hidden;
mod tally;

pub use hidden::HiddenPlant;
pub use tally::{Coverage, Shown};
