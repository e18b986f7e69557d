//! From the end of a check to its status, and the end of the whole run.

use std::collections::HashMap;

use super::assertion::{Failure, RuleResult};
use super::check::Check;
use super::client::{Client, REQUEST_LIMIT};
use super::result::{CheckResult, CheckStatus};
use super::time_up::{Starvation, TimeUp};
use crate::prelude::wire::*;

/// Time for all checks of any drive. A line of 115,200 Bd takes two thirds of it.
pub const TIME_LIMIT: Duration = Duration::from_secs(60);
/// Parts of that time, one of which is for one attempt at a check.
const PARTS: u32 = 12;
/// Consecutive checks without a good frame after which the drive is lost.
pub const SILENT_CHECKS: u32 = 3;
/// Attempts of a check that a drive or a bench that stands still may spoil.
pub(super) const ATTEMPTS: u32 = 3;

/// Most characters of a text, whatever a drive sends.
const LONGEST_TEXT: usize = 600;

fn short(mut text: String) -> String {
    if let Some((end, _)) = text.char_indices().nth(LONGEST_TEXT) {
        let end = text[..end].char_indices().rev().nth(2).map_or(0, |(place, _)| place);
        text.truncate(end);
        text.push_str("...");
    }
    text
}

fn passed(limit: Duration) -> String {
    format!("{} s have passed", limit.as_secs())
}

fn failed(expected: String, got: String) -> CheckStatus {
    CheckStatus::Failed { expected: short(expected), got: short(got) }
}

/// What earlier checks mean for the next one.
pub(super) struct Judge {
    /// Time for all checks.
    limit: Duration,
    /// When the time for all checks ends, but for the time for which the drive's program waits for a core.
    ends_at: Instant,
    /// At the start.
    starvation: Starvation,
    /// Preparations that failed, each with the name of the check that reports it.
    failed_preparations: HashMap<String, String>,
    /// Consecutive checks without a good frame.
    silent_checks: u32,
    /// Whether the present check was made, in time.
    is_made: bool,
    /// Good frames before the present check.
    messages_before: u32,
}

impl Judge {
    pub(super) fn new(client: &mut Client, limit: Duration) -> Self {
        Self {
            limit,
            ends_at: client.opened_at + limit,
            starvation: Starvation::look(&mut client.line),
            failed_preparations: HashMap::new(),
            silent_checks: 0,
            is_made: false,
            messages_before: 0,
        }
    }

    /// Makes a check on a drive that was just reset.
    pub(super) fn result(
        &mut self,
        client: &mut Client,
        group: &'static str,
        check: Check,
    ) -> Result<CheckResult, SessionError> {
        let Check { rules, name, run } = check;
        let started = client.line.now();
        self.messages_before = client.line.decoder.counters().messages;
        let mut ended = self.attempt(client, &run);
        for _ in 1..ATTEMPTS {
            // A late answer isn't a missing one.
            if !matches!(client.is_answered_late(), Ok(true)) {
                break;
            }
            ended = self.attempt(client, &run);
        }
        let status = match ended {
            Ok(()) => CheckStatus::Passed,
            Err(Failure::Rule { expected, got }) => failed(expected, got),
            Err(Failure::Preparation { what, expected, got }) => self.unprepared(&name, what, expected, got),
            Err(Failure::Skipped { reason }) => CheckStatus::Skipped { reason },
            Err(Failure::NotJudged { cause }) => CheckStatus::NotJudged { cause: short(cause) },
            Err(Failure::Session(error)) => return Err(error),
        };
        // What ends a check early may leave answers on their way.
        client.is_unsettled |=
            matches!(status, CheckStatus::Failed { .. } | CheckStatus::NotJudged { .. }) && self.is_made;
        let took = client.line.now().saturating_duration_since(started);
        let note = short(std::mem::take(&mut client.note));
        Ok(CheckResult { group, rules, name, status, note, took })
    }

    fn attempt(&mut self, client: &mut Client, run: &dyn Fn(&mut Client) -> RuleResult) -> RuleResult {
        let (now, starvation) = (client.line.now(), Starvation::look(&mut client.line));
        let run_ends_at = self.ends_at + self.starvation.until(starvation);
        self.is_made = now < run_ends_at;
        if !self.is_made {
            return Err(Failure::NotJudged { cause: passed(self.limit) });
        }
        let check_limit = self.limit / PARTS;
        client.begin(if now + check_limit < run_ends_at {
            let cause = format!("{} in this check", passed(check_limit));
            TimeUp { at: now + check_limit, cause, starvation }
        } else {
            TimeUp { at: run_ends_at, cause: passed(self.limit), starvation }
        });
        client.reset()?;
        run(client)
    }

    /// The first check that meets a failed preparation reports it.
    fn unprepared(&mut self, name: &str, what: String, expected: String, got: String) -> CheckStatus {
        match self.failed_preparations.get(&what) {
            Some(reported_by) => {
                CheckStatus::NotJudged { cause: short(format!("{what}, see \"{reported_by}\"")) }
            }
            None => {
                let expected = format!("{what} before the check: {expected}");
                self.failed_preparations.insert(what, name.to_owned());
                failed(expected, got)
            }
        }
    }

    /// # Errors
    /// The drive has sent no good frame in the last checks.
    pub(super) fn require_frames(&mut self, client: &Client) -> Result<(), SessionError> {
        let is_silent = self.is_made && client.line.decoder.counters().messages == self.messages_before;
        self.silent_checks = if is_silent { self.silent_checks + 1 } else { 0 };
        if self.silent_checks < SILENT_CHECKS {
            return Ok(());
        }
        Err(client.line.silent("the requests of three checks", REQUEST_LIMIT * SILENT_CHECKS))
    }
}
