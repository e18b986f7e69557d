//! The scope of the drive: signals at the rate of the loop, around an event, to be read after it.

use lashloop_protocol::enums::{CaptureTrigger, Outcome};
use lashloop_protocol::limits::{MAX_SIGNALS, MAX_TELEMETRY_VALUES};
use lashloop_protocol::message::{Capture, CaptureRows};
use lashloop_protocol::telemetry_values::TelemetryValues;

use super::refusal::Refusal;
use super::safety::Violation;
use super::subscription::{check_indices, check_law};
use crate::law::Signal;

/// Values in the memory: 256 rows of four signals, 1024 rows of one.
const VALUES: usize = 1024;
/// Most signals of a capture.
const MOST_SIGNALS: u32 = 4;

/// One capture at a time, and the memory of its rows.
pub(super) struct Scope {
    capture: Captured,
    values: [f32; VALUES],
}

/// How far a capture is.
#[derive(Clone, Copy)]
pub(super) enum Captured {
    Off,
    /// Before the event; the newest row may become that of the event.
    Waiting {
        rows: Rows,
        pace: Pace,
        /// Most rows to be kept before the event.
        before: u16,
        trigger: Trigger,
    },
    /// After the event, until the memory is full or the run ends.
    Recording {
        rows: Rows,
        pace: Pace,
        /// Number of the row of the event.
        event: u16,
    },
    Complete {
        rows: Rows,
        /// The number of rows if none is at or after the event.
        event: u16,
    },
}

/// The rows in the memory, a ring.
#[derive(Clone, Copy)]
pub(super) struct Rows {
    /// Bit `n` for the signal with index `n`.
    signals: u32,
    /// Place of the oldest row.
    first: u16,
    count: u16,
}

/// Which steps have a row.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    every: u16,
    /// Steps without a row before the next one.
    left: u16,
}

#[derive(Clone, Copy)]
pub(super) enum Trigger {
    Now,
    Level(Level),
    Fault,
}

/// A signal passes a level. Downwards is upwards with the opposite sign.
#[derive(Clone, Copy)]
pub(super) struct Level {
    signal: u8,
    sign: f32,
    level: f32,
    /// Whether the row before was on the other side.
    was_below: bool,
}

impl Default for Scope {
    fn default() -> Self {
        Self { capture: Captured::Off, values: [0.0; VALUES] }
    }
}

impl Scope {
    /// Replaces the capture.
    pub(super) fn set(&mut self, capture: Captured) {
        self.capture = capture;
    }

    /// Checks that a law has every signal that a step may yet record.
    ///
    /// # Errors
    /// The first signal that the law lacks.
    pub(super) fn check(&self, law: u32, table: &[Signal]) -> Result<(), Refusal> {
        self.capture.check(law, table)
    }

    /// To be called after every control step, with the fault that it ends in; `signals` gives the values of all signals.
    #[inline]
    pub(super) fn step(&mut self, fault: Option<&Violation>, signals: impl FnOnce() -> [f32; MAX_SIGNALS]) {
        let (Captured::Waiting { pace, .. } | Captured::Recording { pace, .. }) = &mut self.capture else {
            return;
        };
        // Without a step of the law the values are those of the step before.
        if !fault.is_some_and(Violation::precedes_law) && pace.is_due() {
            self.record(&signals(), fault.is_some());
        }
    }

    #[inline(never)]
    fn record(&mut self, all: &[f32; MAX_SIGNALS], is_fault: bool) {
        self.capture = match self.capture {
            Captured::Waiting { mut rows, pace, before, mut trigger } => {
                if rows.count > before {
                    rows.drop_first();
                }
                rows.push(all, &mut self.values);
                let is_event = match &mut trigger {
                    Trigger::Now => rows.count > before,
                    Trigger::Level(level) => level.is_passed_by(all),
                    Trigger::Fault => is_fault,
                };
                if is_event {
                    Captured::after_event(rows, pace, rows.count - 1)
                } else {
                    Captured::Waiting { rows, pace, before, trigger }
                }
            }
            Captured::Recording { mut rows, pace, event } => {
                rows.push(all, &mut self.values);
                Captured::after_event(rows, pace, event)
            }
            ended @ (Captured::Off | Captured::Complete { .. }) => ended,
        };
    }

    /// The drive latches a fault. That of a step with a row has its event; any other comes after the last row.
    pub(super) fn fault(&mut self) {
        if let Captured::Waiting { mut rows, before, trigger: Trigger::Fault, .. } = self.capture {
            if rows.count > before {
                rows.drop_first();
            }
            self.capture = Captured::Complete { rows, event: rows.count };
        }
    }

    /// Every run has a row of its first step.
    pub(super) fn begin_run(&mut self) {
        // A session that ended the run before has left its recording.
        self.end_run();
        if let Captured::Waiting { pace, .. } = &mut self.capture {
            pace.left = 0;
        }
    }

    /// Without further steps a recording is complete. A capture before its event waits for the next run.
    pub(super) fn end_run(&mut self) {
        if let Captured::Recording { rows, event, .. } = self.capture {
            self.capture = Captured::Complete { rows, event };
        }
    }

    /// As many rows as one message holds, from number `first` on.
    ///
    /// # Errors
    /// [`Outcome::NotCaptured`] without a complete capture, [`Outcome::UnknownIndex`] beyond its last row.
    pub(super) fn read(&self, first: u16) -> Result<CaptureRows, Refusal> {
        let not_captured = |detail| Refusal { outcome: Outcome::NotCaptured, detail };
        let (rows, event) = match self.capture {
            Captured::Off => return Err(not_captured(0)),
            Captured::Waiting { .. } => return Err(not_captured(1)),
            Captured::Recording { .. } => return Err(not_captured(2)),
            Captured::Complete { rows, event } => (rows, event),
        };
        let mut values = heapless::Vec::<f32, MAX_TELEMETRY_VALUES>::new();
        for row in (first..rows.count).take(MAX_TELEMETRY_VALUES / rows.width()) {
            values.extend(self.values.iter().copied().skip(rows.place(row)).take(rows.width()));
        }
        let beyond = Refusal { outcome: Outcome::UnknownIndex, detail: rows.count.into() };
        let values = TelemetryValues::new(&values).ok_or(beyond)?;
        Ok(CaptureRows { first, event, values })
    }
}

impl Captured {
    /// The capture of a request.
    ///
    /// # Errors
    /// [`Outcome::UnknownIndex`] for a bit without a signal and for a trigger's signal that isn't captured,
    /// [`Outcome::OutOfRange`] for any other value that no capture has.
    pub(super) fn requested(request: &Capture, table: &[Signal]) -> Result<Self, Outcome> {
        let Capture { signals, every, before, trigger, trigger_signal, level } = *request;
        if signals == 0 {
            return Ok(Self::Off);
        }
        check_indices(signals, table)?;
        let rows = Rows { signals, first: 0, count: 0 };
        if signals.count_ones() > MOST_SIGNALS || every == 0 || before >= rows.capacity() {
            return Err(Outcome::OutOfRange);
        }
        let passing = |sign: f32| {
            if signals.checked_shr(trigger_signal.into()).unwrap_or(0) & 1 == 0 {
                return Err(Outcome::UnknownIndex);
            }
            if !level.is_finite() {
                return Err(Outcome::OutOfRange);
            }
            Ok(Trigger::Level(Level { signal: trigger_signal, sign, level: sign * level, was_below: false }))
        };
        let trigger = match trigger {
            CaptureTrigger::Now => Trigger::Now,
            CaptureTrigger::Rising => passing(1.0)?,
            CaptureTrigger::Falling => passing(-1.0)?,
            CaptureTrigger::Fault => Trigger::Fault,
            CaptureTrigger::Unknown(_) => return Err(Outcome::OutOfRange),
        };
        Ok(Self::Waiting { rows, pace: Pace { every, left: 0 }, before, trigger })
    }

    /// As [`Scope::check`].
    ///
    /// # Errors
    /// As [`Scope::check`].
    pub(super) fn check(&self, law: u32, table: &[Signal]) -> Result<(), Refusal> {
        match self {
            Self::Waiting { rows, .. } | Self::Recording { rows, .. } => check_law(rows.signals, law, table),
            Self::Off | Self::Complete { .. } => Ok(()),
        }
    }

    fn after_event(rows: Rows, pace: Pace, event: u16) -> Self {
        if rows.count == rows.capacity() {
            Self::Complete { rows, event }
        } else {
            Self::Recording { rows, pace, event }
        }
    }
}

impl Rows {
    /// Values of a row.
    fn width(&self) -> usize {
        self.signals.count_ones() as usize
    }

    fn capacity(&self) -> u16 {
        (VALUES / self.width()) as u16
    }

    /// Index of the first value of the row with this number.
    fn place(&self, row: u16) -> usize {
        let place = self.first + row;
        let place = if place < self.capacity() { place } else { place - self.capacity() };
        usize::from(place) * self.width()
    }

    /// To be called if there is a place.
    fn push(&mut self, all: &[f32; MAX_SIGNALS], values: &mut [f32; VALUES]) {
        let captured = all.iter().enumerate().filter(|(index, _)| self.signals >> index & 1 != 0);
        let places = values.iter_mut().skip(self.place(self.count));
        places.zip(captured).for_each(|(place, (_, value))| *place = *value);
        self.count += 1;
    }

    fn drop_first(&mut self) {
        self.first = if self.first + 1 < self.capacity() { self.first + 1 } else { 0 };
        self.count -= 1;
    }
}

impl Pace {
    fn is_due(&mut self) -> bool {
        let is_due = self.left == 0;
        self.left = if is_due { self.every } else { self.left } - 1;
        is_due
    }
}

impl Level {
    fn is_passed_by(&mut self, all: &[f32; MAX_SIGNALS]) -> bool {
        let value = all.get(usize::from(self.signal)).map_or(f32::NAN, |value| self.sign * value);
        let was_below = core::mem::replace(&mut self.was_below, value < self.level);
        was_below && value >= self.level
    }
}
