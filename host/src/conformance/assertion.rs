//! Assertions on what a drive sends: have, want, and what the difference means.

use std::fmt::Debug;

use lashloop_bench::session::SessionError;
use lashloop_protocol::{DriveMessage, Message};

/// Whether a drive keeps the rule under test.
pub(super) type RuleResult = Result<(), Failure>;

/// Why a check ended early.
pub(super) enum Failure {
    /// The rule is broken.
    Rule { expected: String, came: String },
    /// Nothing this drive takes would show whether it keeps the rule.
    Skipped { reason: &'static str },
    /// The conversation can't go on.
    Session(SessionError),
}

/// Holds what came against a condition.
pub(super) fn expect(holds: bool, expected: impl Into<String>, came: impl Debug) -> RuleResult {
    if holds { Ok(()) } else { Err(Failure::Rule { expected: expected.into(), came: format!("{came:?}") }) }
}

/// Holds what came against the one thing that may come.
pub(super) fn equal<T: PartialEq + Debug>(what: &str, expected: T, came: T) -> RuleResult {
    expect(expected == came, format!("{what} {expected:?}"), came)
}

/// The names of messages, for rules about what comes and in which order.
pub(super) fn names(answers: &[DriveMessage]) -> Vec<&'static str> {
    answers.iter().map(|answer| answer.layout().name).collect()
}

/// The first answer of the kind that `wanted` recognises.
pub(super) fn find<T>(
    what: &str,
    answers: &[DriveMessage],
    wanted: impl Fn(&DriveMessage) -> Option<T>,
) -> Result<T, Failure> {
    answers.iter().find_map(wanted).ok_or_else(|| Failure::Rule {
        expected: what.to_owned(),
        came: if answers.is_empty() { "nothing".to_owned() } else { format!("{answers:?}") },
    })
}
