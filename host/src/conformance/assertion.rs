//! Assertions on what a drive sends: have, want, and what the difference means.

use std::fmt::Debug;

use lashloop_bench::session::SessionError;
use lashloop_protocol::{DriveMessage, Message};

/// Whether a drive keeps the rule under test.
pub(super) type RuleResult = Result<(), Failure>;

/// What ends a check early.
pub(super) enum Failure {
    /// The rule is broken.
    Rule { expected: String, got: String },
    /// No setting of this drive can test the rule.
    Skipped { reason: &'static str },
    /// The session is lost.
    Session(SessionError),
}

/// Requires a condition.
pub(super) fn expect(holds: bool, expected: impl Into<String>, got: impl Debug) -> RuleResult {
    if holds { Ok(()) } else { Err(broken(expected, format!("{got:?}"))) }
}

pub(super) fn broken(expected: impl Into<String>, got: impl Into<String>) -> Failure {
    Failure::Rule { expected: expected.into(), got: got.into() }
}

/// Requires equality.
pub(super) fn equal<T: PartialEq + Debug>(what: &str, expected: T, got: T) -> RuleResult {
    expect(expected == got, format!("{what} {expected:?}"), got)
}

/// The names of messages, for rules on their order.
pub(super) fn names(answers: &[DriveMessage]) -> Vec<&'static str> {
    answers.iter().map(|answer| answer.layout().name).collect()
}

/// The first answer that `wanted` accepts.
pub(super) fn find<T>(
    what: &str,
    answers: &[DriveMessage],
    wanted: impl Fn(&DriveMessage) -> Option<T>,
) -> Result<T, Failure> {
    let got = || if answers.is_empty() { "nothing".to_owned() } else { format!("{answers:?}") };
    answers.iter().find_map(wanted).ok_or_else(|| broken(what, got()))
}

/// Ends a check whose rule this drive can't show.
pub(super) fn skip<T>(reason: &'static str) -> Result<T, Failure> {
    Err(Failure::Skipped { reason })
}
