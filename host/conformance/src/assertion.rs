//! Assertions on what a drive sends: have, want, and what the difference means.

use super::words::Words;
use crate::prelude::wire::*;

/// Whether a drive keeps the rule under test.
pub(super) type RuleResult = Result<(), Failure>;

/// What ends a check early.
pub(super) enum Failure {
    /// The rule is broken.
    Rule { expected: String, got: String },
    /// A step that leads to the rule failed. The first check that meets a failed step reports it.
    Preparation { what: String, expected: String, got: String },
    /// The description, the line or the pins of this drive, or the options of the run exclude the rule.
    Skipped { reason: &'static str },
    /// The rule was not tested: no time is left, or the bench is too busy.
    NotJudged { cause: String },
    /// The session is lost.
    Session(SessionError),
}

impl From<SessionError> for Failure {
    /// A broken line ends the run. Any other error is the drive's answer, or its silence, to a request of a check.
    fn from(error: SessionError) -> Self {
        match error {
            SessionError::Broken { .. } => Self::Session(error),
            error => broken("an answer of the drive", error.to_string()),
        }
    }
}

/// Turns a broken rule in a step of the preparation into a failure of that step. `what` names the step: a later check that
/// needs the same step is not judged.
pub(super) fn preparation<T>(what: impl Into<String>, result: Result<T, Failure>) -> Result<T, Failure> {
    result.map_err(|failure| match failure {
        Failure::Rule { expected, got } => Failure::Preparation { what: what.into(), expected, got },
        other => other,
    })
}

/// Requires a condition.
pub(super) fn expect(holds: bool, expected: impl Into<String>, got: impl Words) -> RuleResult {
    if holds { Ok(()) } else { Err(broken(expected, got.words())) }
}

pub(super) fn broken(expected: impl Into<String>, got: impl Into<String>) -> Failure {
    Failure::Rule { expected: expected.into(), got: got.into() }
}

/// Requires equality.
pub(super) fn equal<T: PartialEq + Words>(what: &str, expected: T, got: T) -> RuleResult {
    expect(expected == got, format!("{what} {}", expected.words()), got)
}

/// The names of messages, for rules on their order.
pub(super) fn names(answers: &[DriveMessage]) -> Vec<&'static str> {
    answers.iter().map(|answer| answer.layout().name).collect()
}

/// Requires answers of these kinds, in this order.
pub(super) fn of_kinds(
    what: &str,
    kinds: &[&'static str],
    answers: Vec<DriveMessage>,
) -> Result<Vec<DriveMessage>, Failure> {
    equal(what, kinds, &*names(&answers))?;
    Ok(answers)
}

/// The first answer that `wanted` accepts.
pub(super) fn find<T>(
    what: &str,
    answers: &[DriveMessage],
    wanted: impl Fn(&DriveMessage) -> Option<T>,
) -> Result<T, Failure> {
    answers.iter().find_map(wanted).ok_or_else(|| broken(what, answers.words()))
}

/// Ends a check that the drive's description excludes.
pub(super) fn skip<T>(reason: &'static str) -> Result<T, Failure> {
    Err(Failure::Skipped { reason })
}
