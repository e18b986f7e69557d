//! The watchdog: no torque outlives the samples it was computed from.
//!
//! While the drive runs, a new sample must arrive within `watchdog_us` of the last one, or of the start; in bench mode a
//! reference. A repeated or out-of-sequence sample doesn't restart the watchdog. Time is device time.

use core::time::Duration;

use lashloop_protocol::enums::FaultCode;

use super::safety::Violation;

pub(super) struct Watchdog {
    timeout: Duration,
    restarted_at: Duration,
}

impl Watchdog {
    pub(super) fn start(timeout_us: u32, now: Duration) -> Self {
        Self { timeout: Duration::from_micros(timeout_us.into()), restarted_at: now }
    }

    pub(super) fn restart(&mut self, now: Duration) {
        self.restarted_at = now;
    }

    /// The last instant at which a new sample is in time.
    pub(super) fn deadline(&self) -> Duration {
        self.restarted_at + self.timeout
    }

    /// Trips after the deadline; the deadline itself is in time.
    pub(super) fn check(&self, now: Duration) -> Result<(), Violation> {
        let silence = now.saturating_sub(self.restarted_at);
        if silence <= self.timeout {
            return Ok(());
        }
        // Only for a fault: a microcontroller converts 64 bits to a float in software.
        let (value, limit) = (silence.as_secs_f32(), self.timeout.as_secs_f32());
        Err(Violation { value, limit, ..Violation::of(FaultCode::Watchdog) })
    }
}
