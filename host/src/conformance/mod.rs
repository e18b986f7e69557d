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
mod assertion;
mod check;
mod client;
mod encoders;
mod handshake;
pub mod junit;
mod latency;
mod line;
mod parameters;
mod range;
mod reactions;
mod result;
mod safety;
mod samples;
mod states;
mod transitions;

use std::time::Instant;

use lashloop_protocol::message::Identity;

pub use latency::LIMIT as ANSWER_LIMIT;
pub use parameters::REQUIRED_PARAMETERS;
pub use result::{CheckResult, CheckStatus};

use assertion::Failure;
use check::Check;
use client::Client;
use lashloop_bench::link::Link;
use lashloop_bench::session::SessionError;

/// Whether time passes for the drive while the bench waits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceTime {
    /// It does: a board, an emulator, a process.
    Passes,
    /// It does not: a drive called in process. Checks that wait for it are left out, and counted as left out.
    StandsStill,
}

/// Receives the results while the checks run.
pub trait Reporter {
    /// The handshake is complete.
    fn connected(&mut self, _identity: &Identity) {}

    /// A check has ended, or was skipped.
    fn checked(&mut self, result: &CheckResult);

    /// Whether to end before the next check.
    fn is_interrupted(&self) -> bool {
        false
    }
}

/// Runs the whole battery on a fresh link and leaves the drive reset. `session` is the first session's number, as for
/// [`Session::open`](lashloop_bench::session::Session::open).
///
/// # Errors
/// Nobody answers, what answers speaks another version, or the line breaks. A single answer that stays out is not an
/// error but a finding.
pub fn run(
    link: Box<dyn Link>,
    session: u32,
    time: DeviceTime,
    reporter: &mut dyn Reporter,
) -> Result<(), SessionError> {
    let mut client = Client::open(link, session)?;
    reporter.connected(client.identity());
    for check in all_checks() {
        if reporter.is_interrupted() {
            break;
        }
        let started = Instant::now();
        let status = match time {
            DeviceTime::StandsStill if check.waits => {
                CheckStatus::Skipped { reason: "not run: in process no device time passes" }
            }
            _ => match client.reset().and_then(|()| (check.run)(&mut client)) {
                Ok(()) => CheckStatus::Passed,
                Err(Failure::Rule { expected, came }) => CheckStatus::Failed { expected, came },
                Err(Failure::Skipped { reason }) => CheckStatus::Skipped { reason },
                Err(Failure::Session(error)) => return Err(error),
            },
        };
        reporter.checked(&CheckResult {
            group: check.group,
            name: check.name,
            status,
            note: client.take_note(),
            took: started.elapsed(),
        });
    }
    client.leave()
}

/// All checks in the order in which they are made.
fn all_checks() -> Vec<Check> {
    [
        handshake::checks(),
        transitions::checks(),
        parameters::checks(),
        samples::checks(),
        encoders::checks(),
        safety::checks(),
        line::checks(),
        latency::checks(),
    ]
    .concat()
}
