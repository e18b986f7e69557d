//! The result of a check.

use std::time::Duration;

/// What came of a check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CheckStatus {
    /// The drive keeps the rule.
    Passed,
    /// The drive breaks the rule.
    Failed {
        /// What the rule asks for.
        expected: String,
        /// What came instead.
        came: String,
    },
    /// The check was not made.
    Skipped {
        /// Why not.
        reason: &'static str,
    },
}

/// One check and what came of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckResult {
    /// The group of the check: the name of its module.
    pub group: &'static str,
    /// The rule, as a sentence.
    pub name: String,
    /// What came of it.
    pub status: CheckStatus,
    /// A figure worth knowing whatever came of it; empty if there is none.
    pub note: String,
    /// How long it took.
    pub took: Duration,
}
