//! One run: a scenario, a device, a verdict.
//!
//! | module | does |
//! |---|---|
//! | [`mod@simulator`] | the simulated side of the loop: plant, encoders, reference |
//! | `plant_from_scenario` | the plant a scenario describes |
//! | [`setup`] | tells the drive what the scenario says |
//! | `runner` | from a scenario and a device to a verdict: [`run`] |
//! | `control_loop` | one step, whatever paces it |
//! | `lockstep` | paces by the drive: the plant waits for it |
//! | [`real_time`] | paces by the clock on the wall |
//! | `step_sink` | what is kept of every step |
//! | [`outcome`] | what came of it |

mod control_loop;
mod lockstep;
pub mod outcome;
mod plant_from_scenario;
pub mod real_time;
mod runner;
pub mod setup;
pub mod simulator;
mod step_sink;

use crate::atomic_file::WriteError;
use crate::device::DeviceError;
use crate::fault::timeline::UnsupportedFault;
use crate::scenario::ScenarioError;
use lashloop_plant::{ParameterError, PlantError};

pub use outcome::{End, Outcome};
pub use runner::{Clock, run};
pub use step_sink::{Step, Watcher};

/// Why a run could not be made or not be finished.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scenario asks the drive for something it does not take.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The drive's parameters don't go together.
    #[error("the drive says \"{said}\": change [controller.parameters], [encoders] or [run] in the scenario")]
    Inconsistent {
        /// What the drive said about it.
        said: String,
    },
    /// The scenario's plant can't be built.
    #[error(transparent)]
    Plant(#[from] ParameterError),
    /// The scenario's plant can't be integrated.
    #[error(transparent)]
    Integration(#[from] PlantError),
    /// No reading says where an encoder stands, so no drive can be started here.
    #[error(
        "the {encoder} encoder, with its faults, stands at {counts} counts and a drive that starts knows of at most {}: \
         take a coarser encoder, or start nearer to 0",
        lashloop_protocol::EncoderCounts::MAX
    )]
    TooFarToStart {
        /// Whose.
        encoder: &'static str,
        /// Where it stands, faults of the scenario included.
        counts: i64,
    },
    /// The device or the link.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The record.
    #[error(transparent)]
    Record(#[from] WriteError),
    /// A fault of the scenario can't be applied.
    #[error(transparent)]
    Fault(#[from] UnsupportedFault),
    /// The record is slower than the run.
    #[error("{steps} steps wait to be recorded: write to a faster disk, or leave --out and --capture away")]
    RecordBehind {
        /// Steps waiting.
        steps: usize,
    },
    /// The system can't pace the run.
    #[error("the system can't keep time: {0}")]
    Pace(#[from] std::io::Error),
}
