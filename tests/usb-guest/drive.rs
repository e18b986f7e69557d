//! The drive behind a device.

use std::time::{Duration, Instant};

use lashloop_firmware::drive::{Clock, Drive};

/// A drive that was just powered, and its clock.
pub(crate) struct Powered {
    pub(crate) drive: Drive,
    pub(crate) clock: SincePower,
}

pub(crate) struct SincePower(Instant);

impl Clock for SincePower {
    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}

impl Powered {
    pub(crate) fn new(board: &'static str) -> Self {
        Self { drive: Drive::new(board), clock: SincePower(Instant::now()) }
    }

    pub(crate) fn tick(&mut self) {
        self.drive.tick(self.clock.now());
    }

    /// Time until the next tick; past it, because the watchdog trips after its limit and not at it.
    pub(crate) fn until_tick(&self) -> Option<Duration> {
        const PAST: Duration = Duration::from_micros(100);
        Some(self.drive.next_tick()?.saturating_sub(self.clock.now()) + PAST)
    }

    /// Passes bytes to the drive and returns its output.
    pub(crate) fn exchange(&mut self, mut bytes: &[u8]) -> Vec<u8> {
        let mut output = Vec::new();
        loop {
            bytes = &bytes[self.drive.receive(bytes, &self.clock)..];
            output.extend_from_slice(self.drive.output());
            self.drive.clear_output();
            if bytes.is_empty() {
                return output;
            }
        }
    }
}
