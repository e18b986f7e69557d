//! Injection of a scenario's faults.
//!
//! A fault changes the world around the drive, never the drive's code or the bench's judgement:
//!
//! | module | strikes |
//! |---|---|
//! | [`encoder`] | counts between encoder and sample |
//! | [`motor`] | torque between drive and plant |
//! | [`plant`] | gap, shaft and load |
//! | [`link`] | frames and connection, as a middleware of the link |
//! | [`timeline`] | the drive itself; also keeps the log |
//!
//! Random faults draw from the run's seed, each from a stream of its own, so that a run repeats.

pub mod encoder;
pub mod link;
pub mod motor;
pub mod plant;
mod random;
pub mod schedule;
pub mod timeline;

#[cfg(test)]
pub(crate) mod tests;
