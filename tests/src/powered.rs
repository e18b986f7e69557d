//! A drive with the bytes of its line, without a program of its own.

use std::time::{Duration, Instant};

use lashloop_firmware::drive::{Clock, Drive};

/// A drive that was just powered, and its clock.
pub struct Powered {
    /// The drive.
    pub drive: Drive,
    /// Time since power-up.
    pub clock: SincePower,
}

/// Time since power-up.
pub struct SincePower(Instant);

impl Clock for SincePower {
    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}

impl From<Drive> for Powered {
    fn from(drive: Drive) -> Self {
        Self { drive, clock: SincePower(Instant::now()) }
    }
}

impl Powered {
    /// Lets the drive's own time pass.
    pub fn tick(&mut self) {
        self.drive.tick(self.clock.now());
    }

    /// Time until the next tick; past it, because the watchdog trips after its limit and not at it.
    #[must_use]
    pub fn until_tick(&self) -> Option<Duration> {
        const PAST: Duration = Duration::from_micros(100);
        Some(self.drive.next_tick()?.saturating_sub(self.clock.now()) + PAST)
    }

    /// Whether the drive has ended, and the boot loader of its chip starts.
    #[must_use]
    pub fn enters_loader(&self) -> bool {
        self.drive.enters_loader(self.clock.now())
    }

    /// Passes bytes to the drive and returns its output.
    #[must_use]
    pub fn exchange(&mut self, mut bytes: &[u8]) -> Vec<u8> {
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
