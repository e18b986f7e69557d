//! The wave of the low-speed oscillator at the timer input that measures it, which the models don't drive.

use rigless::device::Level;
use rigless::time::VirtualNanos;

use crate::chip::Chip;

/// Half a period of the oscillator at its typical 32 kHz.
const HALF_PERIOD_NS: u64 = 15_625;
/// Time after a reset in which a firmware may begin to capture: it erases a sector for 2 s, and waits 0.1 s for a crystal.
const LONGEST_START_NS: u64 = 2_500_000_000;

/// The oscillator's wave from the reset until the firmware has captured it. No pin of a board leads to the channel.
#[derive(Debug)]
pub struct LsiCapture {
    reset_at: VirtualNanos,
    is_high: bool,
    has_captured: bool,
    /// `None` once the firmware has captured.
    next: Option<VirtualNanos>,
}

impl LsiCapture {
    /// The wave after a reset.
    #[must_use]
    pub fn after_reset(at: VirtualNanos) -> Self {
        Self { reset_at: at, is_high: false, has_captured: false, next: Some(at) }
    }

    /// Drives the edge that is due at an instant. Returns the instant of the next one.
    pub fn turn(&mut self, chip: &mut Chip, at: VirtualNanos) -> Option<VirtualNanos> {
        let due = self.next?;
        if at < due {
            return Some(due);
        }
        let captures = chip.is_set(&chip.part.registers().captures_lsi);
        if self.has_captured && !captures || at.0 > self.reset_at.0 + LONGEST_START_NS {
            self.next = None;
            return None;
        }
        self.has_captured |= captures;
        self.is_high = !self.is_high;
        chip.part.drive_lsi(at, Level::from(self.is_high));
        Some(*self.next.insert(VirtualNanos(at.0 + HALF_PERIOD_NS)))
    }
}
