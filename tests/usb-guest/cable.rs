//! The cable of a device: pulled once the host has sent a number of bytes, and some time later.

use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use tests::usb::urb::Urb;
use usb_device::UsbDirection;

/// The cable of a device.
pub(crate) struct Cable {
    bytes_left: usize,
    delay: Duration,
    pulled_at: Option<Instant>,
}

impl Cable {
    /// From the words `BYTES DELAY_US`. Without words it is never pulled.
    pub(crate) fn new(words: &[&str]) -> Result<Self> {
        let (bytes_left, delay_us) = match words {
            [] => (usize::MAX, 0),
            [bytes, delay_us] => (bytes.parse()?, delay_us.parse()?),
            _ => bail!("{words:?} instead of BYTES DELAY_US"),
        };
        Ok(Self { bytes_left, delay: Duration::from_micros(delay_us), pulled_at: None })
    }

    /// Counts what the host sends.
    pub(crate) fn carry(&mut self, urb: &Urb) {
        if urb.endpoint != 0 && urb.direction == UsbDirection::Out {
            self.bytes_left = self.bytes_left.saturating_sub(urb.data.len());
        }
        if self.bytes_left == 0 {
            self.pull();
        }
    }

    /// Has it pulled after the delay.
    pub(crate) fn pull(&mut self) {
        self.pulled_at.get_or_insert(Instant::now() + self.delay);
    }

    /// Time until it is pulled, if that is known.
    pub(crate) fn time_left(&self) -> Option<Duration> {
        Some(self.pulled_at?.saturating_duration_since(Instant::now()))
    }
}
