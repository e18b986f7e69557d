//! Conformance of a drive to the protocol, checked rule by rule.
//!
//! | module | checks |
//! |---|---|
//! | `burst` | several requests in one write |
//! | `handshake` | identity, sessions, versions |
//! | `transitions` | every request in every state |
//! | `description` | laws, signals and choices |
//! | `parameters` | descriptions, ranges, read-back, refusals, effects |
//! | `samples` | torque for samples, the rules of the sequence |
//! | `telemetry` | subscriptions and the values of signals |
//! | `encoders` | wraparound, jumps and ambiguous positions |
//! | `safety` | torque limit, latched faults, watchdog |
//! | `receiver` | noise, damaged and refused frames |
//! | `aftermath` | what earlier messages and runs leave behind |
//! | `growth` | requests, bodies and values of a newer host, numbers, names |
//! | `pins` | the options: bench mode and boot loader, as far as they need no hardware |
//! | `options` | stored parameters, zero of the encoders, captures |
//! | `bench_mode` | runs on the drive's own encoders, if the host allows them |
//! | `line` | the line report |
//! | `profile_pd` | the optional profile `pd`, by its golden trace |
//! | `latency` | response times |
//! | `endurance` | silence, long watchdogs, large counts |
//!
//! `arrivals` checks every message that arrives: each answer has the number of a request that waits, in the order of the requests,
//! and device time doesn't run backwards.
//!
//! Each check is one rule, stated as a sentence with the numbers of the rules in the specification, and starts from a drive that
//! was just reset. A check depends on another one only where one says so: what the first one finds of bursts decides how all later
//! ones send, and the last names the values that all have seen. After each request the client sends a second one with a known answer. A
//! drive answers in order, so that answer ends the list without a timeout.
//!
//! The steps that lead to a rule are preparations. The first check that meets a failed preparation reports it as its own
//! failure; the checks after it that need the same step are not judged.
//!
//! The checks depend on the protocol and on [`REQUIRED_PARAMETERS`], not on the control law: of the law they require only
//! R10.4, R10.5, R10.13 and R10.14.

#![forbid(unsafe_code)]

mod aftermath;
mod answers;
mod arrivals;
mod assertion;
mod bench_mode;
mod burst;
mod check;
mod client;
mod constancy;
mod damage;
mod description;
mod encoders;
mod endurance;
mod exchanges;
mod growth;
mod handshake;
mod judge;
mod latency;
mod line;
mod moment;
mod options;
mod parameters;
mod pins;
mod power_stage;
mod prelude;
mod profile_pd;
mod range;
mod reactions;
mod receiver;
mod repetition;
mod requests;
mod result;
mod safety;
mod samples;
mod sessions;
mod states;
mod telemetry;
mod time_up;
mod transitions;
pub mod unchecked;
mod words;
mod writes;

use std::time::Duration;

use lashloop_protocol::message::Identity;

pub use judge::{SILENT_CHECKS, TIME_LIMIT};
pub use lashloop_protocol::parameter_names::REQUIRED as REQUIRED_PARAMETERS;
pub use latency::LIMIT as ANSWER_LIMIT;
pub use power_stage::PowerStage;
pub use result::{CheckResult, CheckStatus};

use check::Check;
use client::Client;
use judge::Judge;
use lashloop_link::Link;
use lashloop_session::SessionError;

/// Receives the results while the checks run.
pub trait Reporter {
    /// The handshake is complete.
    fn connected(&mut self, _identity: &Identity) {}

    /// A check has ended, or was omitted.
    fn checked(&mut self, result: &CheckResult);

    /// Whether to run this check.
    fn wants(&self, _group: &str, _name: &str) -> bool {
        true
    }

    /// Whether the drive may run in bench mode, on its own encoders and with its power stage on, and how.
    fn bench_mode(&self) -> Option<PowerStage> {
        None
    }

    /// Time for all checks; a twelfth of it is for one attempt at a check. An emulated drive needs more.
    fn time_limit(&self) -> Duration {
        TIME_LIMIT
    }

    /// Whether to end before the next check.
    fn is_interrupted(&self) -> bool {
        false
    }
}

/// Runs all checks on a newly opened link and resets the drive at the end. `session` is the number of the first session, as for
/// [`Session::open`](lashloop_session::Session::open).
///
/// # Errors
/// The handshake times out, the drive has another protocol version, the link fails, or the drive sends no good frame in three
/// consecutive checks, or none during its description. A single missing answer fails its check and is not an error.
pub fn run(link: Box<dyn Link>, session: u32, reporter: &mut dyn Reporter) -> Result<(), SessionError> {
    let mut client = match Client::open(link, session) {
        Ok(client) => client,
        Err(error) => {
            let Some(result) = description::undescribed(&error) else { return Err(error) };
            reporter.checked(&result);
            return Ok(());
        }
    };
    client.bench_mode = reporter.bench_mode();
    reporter.connected(&client.identity);
    let mut judge = Judge::new(&mut client, reporter.time_limit());
    for (group, check) in all_checks() {
        if reporter.is_interrupted() {
            break;
        }
        if !reporter.wants(group, &check.name) {
            continue;
        }
        reporter.checked(&judge.result(&mut client, group, check)?);
        judge.require_frames(&client)?;
    }
    client.leave()
}

/// A check that the battery makes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Group of the check, which is the name of its module.
    pub group: &'static str,
    /// Numbers of the rules under test, separated by spaces.
    pub rules: &'static str,
    /// The rule, as a sentence.
    pub name: String,
}

/// All checks, in order. Needs no drive.
pub fn list() -> impl Iterator<Item = Listed> {
    all_checks().map(|(group, Check { rules, name, .. })| Listed { group, rules, name })
}

/// All checks, in order, each with the name of its group.
fn all_checks() -> impl Iterator<Item = (&'static str, Check)> {
    let groups = [
        ("burst", burst::checks()),
        ("handshake", handshake::checks()),
        ("transitions", transitions::checks()),
        (description::GROUP, description::checks()),
        ("parameters", parameters::checks()),
        ("samples", samples::checks()),
        ("telemetry", telemetry::checks()),
        ("encoders", encoders::checks()),
        ("safety", safety::checks()),
        ("receiver", receiver::checks()),
        ("aftermath", aftermath::checks()),
        ("growth", growth::checks()),
        ("pins", pins::checks()),
        ("options", options::checks()),
        ("bench_mode", bench_mode::checks()),
        ("line", line::checks()),
        ("profile_pd", profile_pd::checks()),
        ("latency", latency::checks()),
        ("endurance", endurance::checks()),
    ];
    groups.into_iter().flat_map(|(group, checks)| checks.into_iter().map(move |check| (group, check)))
}
