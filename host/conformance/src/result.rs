//! The result of a check.

use std::time::Duration;

use serde::{Serialize, Serializer};

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "status", rename_all = "kebab-case")]
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
    /// The drive's own description, its line, its pins or the options of the run exclude the rule.
    Skipped {
        reason: &'static str,
    },
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CheckResult {
    /// Group of the check, which is the name of its module.
    pub group: &'static str,
    /// Numbers of the rules under test, separated by spaces.
    pub rules: &'static str,
    /// The rule, as a sentence.
    pub name: String,
    #[serde(flatten)]
    pub status: CheckStatus,
    /// A measurement for information; empty if there is none.
    pub note: String,
    #[serde(rename = "took_s", serialize_with = "seconds")]
    pub took: Duration,
}

fn seconds<S: Serializer>(time: &Duration, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(time.as_secs_f64())
}
