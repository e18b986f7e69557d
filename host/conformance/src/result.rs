//! The result of a check.

use std::time::Duration;

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CheckStatus {
    Passed,
    /// The drive breaks the rule. Both texts use the words and units of the protocol's specification.
    Failed {
        expected: String,
        got: String,
    },
    /// The rule was not tested: a failed preparation, which another check reports, or the end of the time.
    NotJudged {
        cause: String,
    },
    /// The drive's own description excludes the rule.
    Skipped {
        reason: &'static str,
    },
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckResult {
    /// Group of the check, which is the name of its module.
    pub group: &'static str,
    /// Numbers of the rules under test, separated by spaces.
    pub rules: &'static str,
    /// The rule, as a sentence.
    pub name: String,
    pub status: CheckStatus,
    /// A measurement for information; empty if there is none.
    pub note: String,
    pub took: Duration,
}
