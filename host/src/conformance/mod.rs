//! Whether a drive keeps to the protocol: a battery of checks for anything that claims to be a drive.
//!
//! | module | checks |
//! |---|---|
//! | `greeting` | identity, sessions, versions |
//! | `transitions` | every request in every state, and requests of another session |
//! | `parameters` | descriptions, ranges, read-back, refusals |
//! | `samples` | torque for samples, the rules of the sequence, telemetry |
//! | `encoders` | readings that wrap, jump, or can't be told apart |
//! | `safety` | limits, faults, watchdog; no torque where there should be none |
//! | `line` | noise, damage, and what the drive tells of it |
//! | `answers` | how long answers take |
//!
//! Each check is one rule as a sentence and starts from a drive that was just reset, so a broken rule fails its own
//! check and no other check's result depends on it. To know that nothing more is to come, the client sends a question
//! with a known answer behind each request instead of waiting: a drive answers in the order in which it was asked.
//!
//! The checks know the protocol and the names of the parameters that a bench sets ([`REQUIRED_PARAMETERS`]), not the
//! control law: that a standing load off its reference gets some torque is all they ask of it.

mod answers;
mod check;
mod client;
mod encoders;
mod greeting;
pub mod junit;
mod line;
mod parameters;
mod safety;
mod samples;
mod transitions;

use std::time::{Duration, Instant};

use lashloop_protocol::message::Identity;

pub use answers::LIMIT as ANSWER_LIMIT;
pub use parameters::REQUIRED_PARAMETERS;

use check::{Check, Failure};
use client::Client;
use lashloop_bench::link::Link;
use lashloop_bench::session::SessionError;

/// What came of a check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
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
    LeftOut {
        /// Why not.
        reason: &'static str,
    },
}

/// One check and what came of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// The group of the check: the name of its module.
    pub group: &'static str,
    /// The rule, as a sentence.
    pub name: String,
    /// What came of it.
    pub outcome: Outcome,
    /// A figure worth knowing whatever came of it; empty if there is none.
    pub note: String,
    /// How long it took.
    pub took: Duration,
}

/// Who is told of a battery while it runs.
pub trait Watcher {
    /// The drive has been greeted and said who it is.
    fn greeted(&mut self, _identity: &Identity) {}

    /// A check has been made, or left out.
    fn found(&mut self, finding: &Finding);

    /// Whether to end before the next check.
    fn stop_asked(&self) -> bool {
        false
    }
}

/// Runs the whole battery on a fresh link and leaves the drive reset. `session` is the first session's number, as for
/// [`Session::open`](lashloop_bench::session::Session::open).
///
/// # Errors
/// Nobody answers, what answers speaks another version, or the line breaks. A single answer that stays out is not an
/// error but a finding.
pub fn run(link: Box<dyn Link>, session: u32, watcher: &mut dyn Watcher) -> Result<(), SessionError> {
    let mut client = Client::open(link, session)?;
    watcher.greeted(client.identity());
    for check in battery() {
        if watcher.stop_asked() {
            break;
        }
        let started = Instant::now();
        let outcome = match client.fresh().and_then(|()| (check.run)(&mut client)) {
            Ok(()) => Outcome::Passed,
            Err(Failure::Rule { expected, came }) => Outcome::Failed { expected, came },
            Err(Failure::LeftOut { reason }) => Outcome::LeftOut { reason },
            Err(Failure::Session(error)) => return Err(error),
        };
        watcher.found(&Finding {
            group: check.group,
            name: check.name,
            outcome,
            note: client.take_note(),
            took: started.elapsed(),
        });
    }
    client.leave()
}

/// All checks in the order in which they are made.
fn battery() -> Vec<Check> {
    [
        greeting::checks(),
        transitions::checks(),
        parameters::checks(),
        samples::checks(),
        encoders::checks(),
        safety::checks(),
        line::checks(),
        answers::checks(),
    ]
    .concat()
}
