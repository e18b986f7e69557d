//! The result of a check.

use std::time::Duration;

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CheckStatus {
    Passed,
    Failed { expected: String, got: String },
    Skipped { reason: &'static str },
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckResult {
    /// Group of the check, which is the name of its module.
    pub group: &'static str,
    /// The rule, as a sentence.
    pub name: String,
    pub status: CheckStatus,
    /// A measurement for information; empty if there is none.
    pub note: String,
    pub took: Duration,
}
