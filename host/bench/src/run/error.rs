//! Why a run fails.

use lashloop_plant::{ParameterError, PlantError};

use crate::atomic_file::WriteError;
use crate::device::DeviceError;
use crate::fault::timeline::UnsupportedFault;
use crate::scenario::{ScenarioError, ScenarioErrors};
use crate::timing::ClockName;
use crate::verdict::Exit;

/// Why a run could not be started or finished.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The drive does not take settings of the scenario.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// The drive's parameters contradict each other.
    #[error(
        "the drive answered {cause}; change [controller.parameters], [encoders], [bench] or [run] in the scenario"
    )]
    Inconsistent {
        /// The drive's answer in words, with the name of a parameter.
        cause: String,
    },
    /// The scenario's plant can't be built.
    #[error(transparent)]
    Plant(#[from] ParameterError),
    /// The scenario's plant can't be integrated.
    #[error(transparent)]
    Integration(#[from] PlantError),
    /// The drive takes its first position from the first sample, and no reading encodes this one.
    #[error(
        "the {encoder} encoder, with its faults, stands at {counts} counts and a drive starts within {} counts of zero: \
         take a coarser encoder, or start nearer to 0",
        lashloop_protocol::EncoderCounts::MAX
    )]
    TooFarToStart {
        /// `motor` or `load`.
        encoder: &'static str,
        /// Its position in counts, faults of the scenario included.
        counts: i64,
    },
    /// The device or its link failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The record can't be written.
    #[error(transparent)]
    Record(#[from] WriteError),
    /// A fault of the scenario is not supported on this device.
    #[error(transparent)]
    Fault(#[from] UnsupportedFault),
    /// The drive has no pins.
    #[error(
        "{device} has no encoders and no power stage, so it has no bench mode: take inproc, silicon or a board, or --mode hil"
    )]
    NoPins {
        /// The device.
        device: String,
    },
    /// The device has another time in bench mode.
    #[error(
        "{device} can't run in bench mode in {clock}: a drive with a time of its own needs --clock real-time, and inproc needs \
         --clock lockstep; silicon takes both"
    )]
    BenchClock {
        /// The device.
        device: String,
        /// The clock of the run.
        clock: ClockName,
    },
    /// The record is slower than the run.
    #[error("{steps} steps wait to be recorded: write to a faster disk, or omit --out and --capture")]
    RecordBehind {
        /// Steps in the queue.
        steps: usize,
    },
    /// The system can't pace the run.
    #[error("the system can't keep time: {0}")]
    Pace(#[from] std::io::Error),
}

impl RunError {
    /// The exit code of a run that fails so.
    #[must_use]
    pub fn exit(&self) -> Exit {
        match self {
            Self::Integration(PlantError::Interrupted) => Exit::Invalid,
            Self::Device(DeviceError::NoScale { .. }) => Exit::UsageOrScenario,
            Self::Device(_) => Exit::DeviceOrLink,
            _ => Exit::UsageOrScenario,
        }
    }
}

impl From<ScenarioError> for RunError {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(error.into())
    }
}
