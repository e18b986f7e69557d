//! What a current sensor shows at no current.

/// The mean of the readings while the bridge is off, and so without current.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorOffset {
    sum: u32,
    count: u32,
    known: Option<f32>,
}

impl SensorOffset {
    /// Readings in a mean: 0.1 s at 10 kHz.
    pub const READINGS: u32 = 1024;

    /// Takes a reading of the converter while the bridge is off, up to 20 bits.
    pub fn take(&mut self, reading: u32) {
        self.sum += reading;
        self.count += 1;
        if self.count == Self::READINGS {
            *self = Self { known: Some(self.sum as f32 / Self::READINGS as f32), ..Self::default() };
        }
    }

    /// Begins a new mean and keeps the last one: the bridge is on, or its current still decays.
    pub fn restart(&mut self) {
        *self = Self { known: self.known, ..Self::default() };
    }

    /// The reading at no current; `None` before the first mean.
    #[must_use]
    pub fn reading(&self) -> Option<f32> {
        self.known
    }
}
