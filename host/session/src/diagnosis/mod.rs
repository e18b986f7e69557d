//! Diagnosis of a line whose drive does not answer: what arrived instead, the probable cause, the remedy.
//!
//! | module | holds |
//! |---|---|
//! | `collector` | counts what arrives, at next to no cost for awaited frames |
//! | `arrivals` | [`Arrivals`]: the counts since the last awaited frame |
//! | `raw_bytes` | statistics of the bytes outside good frames |
//! | `bad_frame` | what a frame is that isn't a message of a drive |
//! | `framing` | mistakes of a firmware in its framing |
//! | `echoed` | an answer that repeats its request wrongly |
//! | `cause` | [`Cause`]: the probable cause |
//! | `report` | [`Diagnosis`] and its sentences |

mod arrivals;
mod bad_frame;
mod cause;
mod collector;
mod echoed;
mod framing;
mod raw_bytes;
mod report;

pub use arrivals::Arrivals;
pub use bad_frame::{CrcVariant, Refusal};
pub use cause::Cause;
pub(crate) use collector::Collector;
pub use echoed::OtherIndex;
pub use framing::FramingMistake;
pub use raw_bytes::RawBytes;
pub use report::Diagnosis;

#[cfg(test)]
mod tests;
