//! `[scope]`: signals that the drive captures around an event, at the rate of its loop.

use serde::Serialize;

use super::declare::{Field, choice, field, integer, number, text};
use super::sections::{SignalChoice, signals};
use crate::settings;

settings! {
    /// The event around which the drive captures.
    pub enum ScopeTrigger {
        /// the first row after those before the event
        "now" => Now,
        /// the signal passes the level upwards
        "rising" => Rising,
        /// the signal passes the level downwards
        "falling" => Falling,
        /// the drive latches a fault
        "fault" => Fault,
    }
}

settings! {
    /// `[scope]`.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct ScopeSettings {
        /// Names of the drive's signals to capture, 4 at most; absent for no capture.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub signals: Option<Vec<SignalChoice>> = signals(),
        /// Steps from one row to the next.
        pub every_steps: u16 = integer(1..=u16::MAX).or(1),
        /// Most rows before the event, fewer than the drive holds; Lashloop's own holds 1024 values.
        pub before_rows: u16 = integer(0..=u16::MAX).or(64),
        /// The event. The capture is complete when the drive's memory is full, or at the end of the run.
        pub trigger: ScopeTrigger = choice().or(ScopeTrigger::Now),
        /// The captured signal that passes the level; absent for the first of `signals`.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub trigger_signal: Option<SignalChoice> = signal(),
        /// The level, in the unit of the signal.
        pub level: f64 = number(-1e9..=1e9).or(0.0),
    }
}

fn signal() -> impl Field<Value = Option<SignalChoice>> {
    field(|name, doc, section| {
        let name_of = text("a signal of the drive in quotes").optional().read(name, doc, section);
        name_of.map(|it| SignalChoice { name: it, origin: section.origin_of(name) })
    })
}

impl ScopeSettings {
    /// The first signal; `None` if nothing is captured.
    #[must_use]
    pub fn first(&self) -> Option<&SignalChoice> {
        self.signals.as_ref()?.first()
    }

    /// Whether nothing is captured.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.first().is_none()
    }
}
