//! The round trip of a line to a drive, measured on the line.

use lashloop_bench::device::{Connection, DeviceChoice, DeviceError, LineSpeed, session_number};
use lashloop_bench::supervisor::Supervisor;
use lashloop_link::latency_timer::LatencyTimer;
use lashloop_session::Session;

use super::round_trip::{self, Timing};

/// A measured line.
#[derive(Debug)]
pub struct MeasuredLine {
    pub timing: Timing,
    /// `None` for a line that isn't a terminal.
    pub latency_timer: Option<LatencyTimer>,
}

impl MeasuredLine {
    /// Opens the line as a run does, with a shortened latency timer if the system permits it, and sends `rounds` samples to the
    /// disarmed drive.
    ///
    /// # Errors
    /// The line can't be opened, or no drive answers.
    pub fn measure(
        choice: &DeviceChoice,
        speed: LineSpeed,
        rounds: u32,
        supervisor: &Supervisor,
    ) -> Result<Self, DeviceError> {
        let timer_before_ms = choice.terminal().and_then(LatencyTimer::read_ms);
        let (link, connection) = Connection::open(choice, speed, supervisor)?;
        let latency_timer =
            choice.terminal().map(|terminal| LatencyTimer::shorten(terminal).since(timer_before_ms));
        let explain = |source| connection.explain(source);
        let mut session = Session::open(link, session_number()).map_err(explain)?;
        let timing = round_trip::measure(&mut session, rounds).map_err(explain)?;
        Ok(Self { timing, latency_timer })
    }
}
