//! Soak: runs of one scenario with rising faults, whose verdicts and resources are checked independently.
//!
//! | module | is |
//! |---|---|
//! | [`plan`] | the scenario of each run: faults that rise from level to level, drawn from the seed |
//! | [`judge`] | the expected verdict of each run, and damaged frames that no counter shows |
//! | [`resource_usage`] | memory and descriptors of a process, and the limits of their growth |
//! | [`tally`] | the totals of all runs |

pub mod judge;
pub mod plan;
pub mod resource_usage;
#[cfg(test)]
mod short_scenario;
pub mod tally;
