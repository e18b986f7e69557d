//! Where the drive is in a run of bench mode.

use std::time::Instant;

use super::step::TraceRow;
use crate::timing::{StepOutcome, StepTiming};

/// Where the drive is in a run of bench mode, as the loop sees it. Instants are of the link's time.
#[derive(Debug, Clone, Copy)]
pub(super) enum BenchPhase {
    /// The drive is started, and no reference is sent.
    Started,
    /// References are sent, and no step is measured.
    AwaitingFirstStep {
        /// When the first reference was sent, or the last report arrived.
        silent_since: Instant,
    },
    /// The drive reports its steps.
    Measuring {
        /// When the last report arrived.
        silent_since: Instant,
        /// Zero of the load's travel, in rad.
        travel_zero_rad: f64,
        /// The last step with a measurement.
        latest: Measurement,
    },
}

/// What the drive has reported of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measurement {
    pub(super) step: u32,
    /// Its time is that of the step that repeats it.
    pub(super) row: TraceRow,
    pub(super) timing: StepTiming,
}

impl BenchPhase {
    /// A reference is sent.
    pub(super) fn note_sent(&mut self, now: Instant) {
        if let Self::Started = self {
            *self = Self::AwaitingFirstStep { silent_since: now };
        }
    }

    /// A report has arrived, of a step or not.
    pub(super) fn note_report(&mut self, now: Instant) {
        match self {
            Self::Started => {}
            Self::AwaitingFirstStep { silent_since } | Self::Measuring { silent_since, .. } => {
                *silent_since = now;
            }
        }
    }

    /// Since when the drive owes a report.
    pub(super) fn silent_since(&self) -> Option<Instant> {
        match *self {
            Self::Started => None,
            Self::AwaitingFirstStep { silent_since } | Self::Measuring { silent_since, .. } => {
                Some(silent_since)
            }
        }
    }

    /// How a step without a measurement of its own went: the drive reports every `sample_every`th step.
    pub(super) fn timing_of(&self, step: u32, sample_every: u32) -> StepTiming {
        match self {
            Self::Measuring { latest, .. } if step / sample_every == latest.step / sample_every => {
                latest.timing
            }
            // Its report is lost.
            Self::Started | Self::AwaitingFirstStep { .. } | Self::Measuring { .. } => {
                StepTiming::of(StepOutcome::Unanswered)
            }
        }
    }
}
