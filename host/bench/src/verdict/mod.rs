//! PASS, FAIL or INVALID: the result of a run, and the exit codes of the tool.
//!
//! FAIL means that the drive has missed an expectation of the scenario. INVALID means that link or timing broke what the
//! scenario allows, so that the run's figures don't judge the drive. INVALID therefore outranks FAIL.
//!
//! | module | is |
//! |---|---|
//! | `exit` | the three verdicts and the exit codes |
//! | `judgement` | from expectations, metrics, counts and timing to a verdict with its reasons |

mod exit;
mod judgement;

pub use exit::{Exit, Verdict};
pub use judgement::{Breach, JudgedExpectation, Judgement, LinkCounts};

#[cfg(test)]
mod tests;
