//! PASS, FAIL or INVALID: the result of a run, and the exit codes of the tool.
//!
//! FAIL means that the drive has missed an expectation of the scenario. INVALID means that link or timing broke what the
//! scenario allows, so that the run's figures don't judge the drive. INVALID therefore outranks FAIL. A torque answer that breaks a rule of the
//! protocol fails the run under any timing and on any line.
//!
//! | module | is |
//! |---|---|
//! | `answer_rule` | the rules that every torque answer of a run must keep |
//! | `exit` | the three verdicts and the exit codes |
//! | `judgement` | from expectations, metrics, counts and timing to a verdict with its reasons |

mod answer_rule;
mod exit;
mod judgement;

pub use answer_rule::{AnswerRule, BrokenRule, BrokenRuleReport};
pub use exit::{Exit, Verdict};
pub use judgement::{Breach, JudgedExpectation, Judgement, LinkCounts};

#[cfg(test)]
mod tests;
