//! What the receiver has counted since the last `Start`, or since power-up before the first one.

use lashloop_protocol::Counters;
use lashloop_protocol::message::LineReport;

#[derive(Default)]
pub(super) struct LineCounts {
    at_start: Counters,
    /// Bytes lost by the hardware, which the decoder can't count.
    overruns: u32,
}

impl LineCounts {
    /// Counting from zero, with the decoder at `now`.
    pub(super) fn starting_at(now: &Counters) -> Self {
        Self { at_start: *now, overruns: 0 }
    }

    pub(super) fn add_overruns(&mut self, count: u32) {
        self.overruns = self.overruns.saturating_add(count);
    }

    /// The report, with the decoder at `now`.
    pub(super) fn report(&self, now: &Counters) -> LineReport {
        let known = now.messages - self.at_start.messages;
        LineReport {
            // A request of a newer minor version is good too: the drive answers it.
            messages: known.saturating_add(now.unknown - self.at_start.unknown),
            damaged: now.damaged() - self.at_start.damaged(),
            refused: now.refused - self.at_start.refused,
            overruns: self.overruns,
            device_time_us: None,
        }
    }
}
