//! What a meter reads from each sample.

use super::measured::Measured;
use super::sample::Sample;
use super::signal_table::{Place, SignalTable};

/// One number of each sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Channel {
    /// Load position less reference.
    Error,
    Torque,
    /// An index of [`FIXED_SIGNALS`](super::FIXED_SIGNALS).
    Fixed(usize),
    Plant(usize),
    Drive(usize),
    /// A signal of the drive minus the plant's truth of the same sample.
    EstimateError {
        drive: usize,
        plant: usize,
    },
}

impl Channel {
    /// The number; `None` for a signal of the drive in a step without telemetry.
    pub(super) fn of(self, sample: &Sample<'_>) -> Option<f64> {
        let plant = |index: usize| sample.plant.get(index).copied();
        let drive = |index: usize| sample.drive.and_then(|values| values.get(index)).copied();
        match self {
            Self::Error => Some(sample.load_position_rad - sample.reference_rad),
            Self::Torque => Some(sample.torque_nm),
            Self::Fixed(index) => sample.fixed().get(index).copied(),
            Self::Plant(index) => plant(index),
            Self::Drive(index) => drive(index),
            Self::EstimateError { drive: estimate, plant: truth } => Some(drive(estimate)? - plant(truth)?),
        }
    }

    /// The channel of a signal by its name among all signals of a run.
    pub(super) fn named(signals: &SignalTable, name: &str) -> Option<Self> {
        Some(match signals.find(name)? {
            Place::Fixed(index) => Self::Fixed(index),
            Place::Plant(index) => Self::Plant(index),
            Place::Drive(index) => Self::Drive(index),
        })
    }

    /// The channel of a signal that a metric needs.
    pub(super) fn needed(signals: &SignalTable, name: &'static str) -> Result<Self, Measured> {
        Self::named(signals, name).ok_or(Measured::MissingSignal(name))
    }

    /// The error of a drive's estimate: both names as [`needed`](Self::needed) takes them.
    pub(super) fn estimate_error(
        signals: &SignalTable,
        estimate: &'static str,
        truth: &'static str,
    ) -> Result<Self, Measured> {
        // The plant's signal first: without a gap there is nothing to estimate.
        let Self::Plant(plant) = Self::needed(signals, truth)? else {
            return Err(Measured::MissingSignal(truth));
        };
        let Self::Drive(drive) = Self::needed(signals, estimate)? else {
            return Err(Measured::MissingSignal(estimate));
        };
        Ok(Self::EstimateError { drive, plant })
    }
}
