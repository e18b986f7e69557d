//! Diagnosis of a line: fitness for a bench, and the remedy.
//!
//! | module | is |
//! |---|---|
//! | [`tty_users`] | processes that have the terminal open |
//! | [`latency_timer`] | delay of received bytes in a USB adapter |
//! | [`round_trip`] | time from sample to torque |
//! | `assessment` | judges each of these |
//! | [`finding`] | the result for one property |
//!
//! A drive that does not answer is diagnosed by the session, for every command alike.
//!
//! The kernel's low-latency flag (`ASYNC_LOW_LATENCY`) needs an ioctl without a safe wrapper. For USB adapters the flag only
//! shortens the latency timer. sysfs can do the same, so we use sysfs.

mod assessment;
pub mod finding;
pub mod latency_timer;
mod line_under_test;
pub mod round_trip;
pub mod tty_users;

use finding::Finding;
use lashloop_bench::device::{Connection, DeviceChoice, session_number};
use lashloop_bench::session::Session;
use lashloop_bench::supervisor::Supervisor;
use line_under_test::LineUnderTest;

#[derive(Debug)]
pub struct Examination {
    /// In the order of the examination.
    pub findings: Vec<Finding>,
    /// Whether the handshake and the measurement completed.
    pub reached: bool,
}

impl Examination {
    /// Whether the handshake completed and no property needs a remedy.
    #[must_use]
    pub fn is_healthy(&self) -> bool {
        self.reached && !self.findings.iter().any(Finding::is_wrong)
    }
}

/// Opens the line to a drive as a run does, opens a session and measures. The drive stays disarmed in `Idle`. A shortened
/// latency timer stays short until the adapter is unplugged. `baud` is the speed of a serial port, in bit/s, and `rounds` the
/// number of samples of the round-trip measurement.
#[must_use]
pub fn examine(choice: &DeviceChoice, baud: u32, rounds: u32, supervisor: &Supervisor) -> Examination {
    let mut findings = Vec::new();
    let ended = examine_steps(choice, baud, rounds, supervisor, &mut findings);
    let reached = ended.is_ok();
    findings.extend(ended.err());
    Examination { findings, reached }
}

/// The error is that of a step on which the others depend.
fn examine_steps(
    choice: &DeviceChoice,
    baud: u32,
    rounds: u32,
    supervisor: &Supervisor,
    findings: &mut Vec<Finding>,
) -> Result<(), Finding> {
    let line = LineUnderTest::new(choice, baud);
    let (link, connection) = Connection::open(choice, baud, supervisor).map_err(|error| {
        let users = choice.terminal().map(tty_users::of).unwrap_or_default();
        assessment::not_opened(&error, &users)
    })?;
    findings.push(assessment::opened(line));
    findings.push(assessment::dtr(line));
    let timer = line.terminal().map(latency_timer::LatencyTimer::shorten);
    findings.push(assessment::latency_timer(line, timer.as_ref()));
    findings.push(assessment::drained());
    let failed = |subject| {
        let connection = &connection;
        move |source| Finding::wrong(subject, connection.explain(source).to_string())
    };
    let mut session = Session::open(link, session_number()).map_err(failed("handshake"))?;
    findings.push(assessment::handshake(&session.identity));
    let timing = round_trip::measure(&mut session, rounds).map_err(failed("round trip"))?;
    findings.push(assessment::round_trip(&timing));
    findings.extend(assessment::losses(&timing, session.traffic().damaged));
    findings.extend(assessment::surplus(&timing));
    findings.push(assessment::speed(&timing, line.wire_time(), timer.as_ref()));
    Ok(())
}
