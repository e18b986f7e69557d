//! Diagnosis of a terminal: fitness for a bench, and the remedy.
//!
//! | module | is |
//! |---|---|
//! | [`tty_users`] | processes that have the terminal open |
//! | [`latency_timer`] | delay of received bytes in a USB adapter |
//! | [`round_trip`] | time from sample to torque |
//! | `assessment` | judges each of these |
//! | [`diagnosis`] | the result for one property |
//!
//! The kernel's low-latency flag (`ASYNC_LOW_LATENCY`) needs an ioctl without a safe wrapper. For USB adapters the flag only
//! shortens the latency timer. sysfs can do the same, so we use sysfs.

mod assessment;
pub mod diagnosis;
pub mod latency_timer;
pub mod round_trip;
pub mod tty_users;

use std::path::Path;

use diagnosis::Diagnosis;
use lashloop_bench::device::{self, DeviceError};
use lashloop_bench::link::pty;
use lashloop_bench::session::Session;
use latency_timer::LatencyTimer;

#[derive(Debug)]
pub struct Examination {
    /// In the order of the examination.
    pub diagnoses: Vec<Diagnosis>,
    /// Whether the handshake and the measurement completed.
    pub reached: bool,
}

impl Examination {
    /// Whether the handshake completed and no property needs a remedy.
    #[must_use]
    pub fn is_healthy(&self) -> bool {
        self.reached && !self.diagnoses.iter().any(Diagnosis::is_wrong)
    }
}

/// Opens the terminal as a run does, opens a session and measures. The drive stays disarmed in `Idle`. A shortened latency
/// timer stays short until the adapter is unplugged. `baud` is the speed of a serial port, in bit/s, and `rounds` the number
/// of samples of the round-trip measurement.
#[must_use]
pub fn examine(terminal: &Path, baud: u32, rounds: u32) -> Examination {
    let mut diagnoses = Vec::new();
    let ended = examine_steps(terminal, baud, rounds, &mut diagnoses);
    let reached = ended.is_ok();
    diagnoses.extend(ended.err());
    Examination { diagnoses, reached }
}

/// The error is that of a step on which the others depend.
fn examine_steps(
    terminal: &Path,
    baud: u32,
    rounds: u32,
    diagnoses: &mut Vec<Diagnosis>,
) -> Result<(), Diagnosis> {
    let is_pty = terminal.starts_with(pty::DIRECTORY);
    let link = device::open_terminal(terminal, baud)
        .map_err(|error| assessment::not_opened(&error, &tty_users::of(terminal)))?;
    diagnoses.push(assessment::opened((!is_pty).then_some(baud)));
    diagnoses.push(assessment::dtr(is_pty));
    let timer = if is_pty { None } else { Some(LatencyTimer::shorten(terminal)) };
    diagnoses.push(assessment::latency_timer(timer.as_ref()));
    let broken = |about| {
        let device = terminal.display().to_string();
        move |source| {
            Diagnosis::wrong(
                about,
                DeviceError::Session { device, stderr: String::new(), source: Box::new(source) }.to_string(),
            )
        }
    };
    diagnoses.push(assessment::drained());
    let mut session = Session::open(link, device::session_number()).map_err(broken("handshake"))?;
    diagnoses.push(assessment::handshake(&session.identity));
    let timing = round_trip::measure(&mut session, rounds).map_err(broken("round trip"))?;
    diagnoses.push(assessment::round_trip(&timing));
    diagnoses.extend(assessment::losses(&timing, session.traffic().damaged));
    let wire = (!is_pty).then(|| round_trip::wire_time(baud));
    diagnoses.push(assessment::speed(&timing, wire, timer.as_ref()));
    Ok(())
}
