//! Is this terminal fit for a bench, and if not, what is to be mended?
//!
//! | module | looks at |
//! |---|---|
//! | [`holder`] | who has the terminal open |
//! | [`latency_timer`] | how long a USB adapter keeps bytes to itself |
//! | [`round_trip`] | how long a sample takes to its torque |
//! | [`diagnosis`] | what each of these means |
//!
//! The kernel's low-latency flag (`ASYNC_LOW_LATENCY`) needs an ioctl for which there is no safe wrapper. What the flag
//! does for USB adapters is to shorten their latency timer, and that can be written in sysfs, so we do it there.

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

/// What to examine.
#[derive(Debug, Clone, Copy)]
pub struct LineUnderTest<'a> {
    /// The terminal.
    pub terminal: &'a Path,
    /// Speed of a serial port, in bits a second.
    pub baud: u32,
    /// Samples to measure with.
    pub rounds: u32,
}

/// What was found, in the order in which it was looked at.
#[derive(Debug)]
pub struct Examination {
    /// One line each.
    pub diagnoses: Vec<Diagnosis>,
    /// Whether the conversation came about.
    pub reached: bool,
}

impl Examination {
    /// Whether there is something to be mended.
    #[must_use]
    pub fn is_healthy(&self) -> bool {
        self.reached && !self.diagnoses.iter().any(Diagnosis::is_wrong)
    }
}

/// Opens the terminal as a run does, greets the drive and measures. The drive is left in `Idle`, unarmed; a latency timer
/// that could be shortened stays short until the adapter is unplugged.
#[must_use]
pub fn examine(line: &LineUnderTest<'_>) -> Examination {
    let mut diagnoses = Vec::new();
    let reached = look(line, &mut diagnoses).is_some();
    Examination { diagnoses, reached }
}

/// `None` as soon as there is nothing more to look at.
fn look(line: &LineUnderTest<'_>, diagnoses: &mut Vec<Diagnosis>) -> Option<()> {
    let &LineUnderTest { terminal, baud, rounds } = line;
    let is_pty = terminal.starts_with(pty::DIRECTORY);
    let link = match device::open_terminal(terminal, baud) {
        Ok(link) => link,
        Err(error) => {
            diagnoses.push(assessment::not_opened(&error, &tty_users::of(terminal)));
            return None;
        }
    };
    diagnoses.push(assessment::opened((!is_pty).then_some(baud)));
    diagnoses.push(assessment::dtr(is_pty));
    let timer = if is_pty { None } else { Some(LatencyTimer::shorten(terminal)) };
    diagnoses.push(assessment::latency_timer(timer.as_ref()));
    let broken = |about, source| {
        let device = terminal.display().to_string();
        Diagnosis::wrong(about, DeviceError::Session { device, source }.to_string())
    };
    diagnoses.push(assessment::drained());
    let mut session = match Session::open(link, device::session_number()) {
        Ok(session) => session,
        Err(source) => {
            diagnoses.push(broken("handshake", source));
            return None;
        }
    };
    diagnoses.push(assessment::handshake(session.identity()));
    let timing = match round_trip::measure(&mut session, rounds) {
        Ok(timing) => timing,
        Err(source) => {
            diagnoses.push(broken("round trip", source));
            return None;
        }
    };
    diagnoses.push(assessment::round_trip(&timing));
    diagnoses.extend(assessment::losses(&timing, session.traffic().damaged));
    let wire = (!is_pty).then(|| round_trip::wire_time(baud));
    diagnoses.push(assessment::speed(&timing, wire, timer.as_ref()));
    Some(())
}
