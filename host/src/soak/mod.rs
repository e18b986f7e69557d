//! Runs over and over, with more and more going wrong: does the bench hold out, and does it judge rightly?
//!
//! | module | is |
//! |---|---|
//! | [`plan`] | the scenario of each run: faults that rise from level to level, drawn from the seed |
//! | [`judge`] | the verdict of each run, judged once more, and what nobody counted |
//! | [`growth`] | memory and descriptors of a process, and how much more they may become |
//! | [`tally`] | what came of all runs |

pub mod growth;
pub mod judge;
pub mod plan;
pub mod tally;
