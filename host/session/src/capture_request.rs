//! What the drive's scope is to capture, and the rows that it has captured.

use lashloop_protocol::enums::CaptureTrigger;

use crate::signals::{DriveSignal, bits};

/// What a drive is to capture.
#[derive(Debug, Clone, PartialEq)]
pub struct CaptureRequest {
    /// One to four signals; sorted by their index.
    pub(crate) signals: Vec<DriveSignal>,
    /// Steps from one row to the next.
    pub every: u16,
    /// Most rows before the event.
    pub before: u16,
    /// The event.
    pub trigger: CaptureTrigger,
    /// Index of the signal whose value is the event.
    pub trigger_signal: u8,
    /// Its value at the event.
    pub level: f32,
}

/// The rows of a complete capture.
#[derive(Debug, Clone, PartialEq)]
pub struct CapturedRows {
    /// The signals, in the order of their values.
    pub signals: Vec<DriveSignal>,
    /// Steps from one row to the next.
    pub every: u16,
    /// Number of the first row at or after the event; the number of rows if none is.
    pub event: u16,
    /// The values of each row.
    pub rows: Vec<Vec<f32>>,
}

impl CaptureRequest {
    /// A capture of these signals from the next step on, as many rows as the drive keeps.
    #[must_use]
    pub fn new(mut signals: Vec<DriveSignal>) -> Self {
        signals.sort_by_key(|signal| signal.index);
        let trigger_signal = signals.first().map_or(0, |signal| signal.index);
        Self { signals, every: 1, before: 0, trigger: CaptureTrigger::Now, trigger_signal, level: 0.0 }
    }

    /// The signals, in the order of their values.
    #[must_use]
    pub fn signals(&self) -> &[DriveSignal] {
        &self.signals
    }

    /// The signals as the bits of `Capture`.
    #[must_use]
    pub fn bits(&self) -> u32 {
        bits(&self.signals)
    }
}
