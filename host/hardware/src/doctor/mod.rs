//! Diagnosis of a line: fitness for a bench, and the remedy.
//!
//! | module | is |
//! |---|---|
//! | [`tty_users`] | processes that have the terminal open |
//! | [`round_trip`] | time from sample to torque |
//! | [`measured_line`] | a line as the axes of a link-budget map have it |
//! | `assessment` | judges each of these |
//! | [`finding`] | the result for one property |
//!
//! A drive that does not answer is diagnosed by the session, for every command alike.
//!
//! The kernel's low-latency flag (`ASYNC_LOW_LATENCY`) needs an ioctl without a safe wrapper. For USB adapters the flag only
//! shortens the latency timer. sysfs can do the same, so we use sysfs.

mod assessment;
pub mod finding;
mod line_under_test;
pub mod measured_line;
pub mod round_trip;
pub mod tty_users;

use finding::Finding;
use lashloop_bench::device::{Connection, DeviceChoice, session_number};
use lashloop_bench::supervisor::Supervisor;
use lashloop_link::latency_timer::LatencyTimer;
use lashloop_session::Session;
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
/// number of samples of the round-trip measurement. `report` receives each finding at once, because the measurement may take
/// many seconds.
pub fn examine(
    choice: &DeviceChoice,
    baud: u32,
    rounds: u32,
    supervisor: &Supervisor,
    mut report: impl FnMut(&Finding),
) -> Examination {
    let mut findings = Vec::new();
    let mut keep = |finding: Finding| {
        report(&finding);
        findings.push(finding);
    };
    let ended = examine_steps(choice, baud, rounds, supervisor, &mut keep);
    let reached = ended.is_ok();
    ended.err().into_iter().for_each(keep);
    Examination { findings, reached }
}

/// The error is that of a step on which the others depend.
fn examine_steps(
    choice: &DeviceChoice,
    baud: u32,
    rounds: u32,
    supervisor: &Supervisor,
    report: &mut impl FnMut(Finding),
) -> Result<(), Finding> {
    let line = LineUnderTest::new(choice, baud);
    let timer_before_ms = line.terminal().and_then(LatencyTimer::read_ms);
    let (link, connection) = Connection::open(choice, baud, supervisor).map_err(|error| {
        let users = choice.terminal().map(tty_users::of).unwrap_or_default();
        assessment::not_opened(&error, &users)
    })?;
    report(assessment::opened(line));
    report(assessment::dtr(line));
    let timer = line.terminal().map(|terminal| LatencyTimer::shorten(terminal).since(timer_before_ms));
    report(assessment::latency_timer(line, timer.as_ref()));
    report(assessment::drained());
    let failed = |subject| {
        let connection = &connection;
        move |source| Finding::wrong(subject, connection.explain(source).to_string())
    };
    let mut session = Session::open(link, session_number()).map_err(failed("handshake"))?;
    report(assessment::handshake(&session.identity));
    session.oddities().into_iter().map(assessment::oddity).for_each(&mut *report);
    let timing = round_trip::measure(&mut session, rounds).map_err(failed("round trip"))?;
    report(assessment::round_trip(&timing));
    assessment::losses(&timing, session.traffic().damaged).into_iter().for_each(&mut *report);
    assessment::surplus(&timing).into_iter().for_each(&mut *report);
    report(assessment::speed(&timing, line.wire_time(), timer.as_ref()));
    Ok(())
}
