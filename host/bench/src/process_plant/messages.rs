//! The lines of the protocol. Both sides ignore fields that they don't know.

use lashloop_plant::{PlantValue, Signal, Start};
use serde::{Deserialize, Serialize};

use lashloop_session::printable;

/// Version of the protocol. A process of another version is rejected.
pub(super) const VERSION: u32 = 1;

/// The bench's first line.
#[derive(Debug, Serialize)]
pub(super) struct Hello<'a> {
    pub(super) lashloop_plant: u32,
    /// Control period in s.
    pub(super) period_s: f64,
    pub(super) initial: Start,
    /// `[plant.settings]` of the scenario.
    pub(super) settings: Option<&'a PlantValue>,
}

/// The process's first line; its initial state follows in the same line.
#[derive(Debug, Deserialize)]
pub(super) struct Description {
    pub(super) lashloop_plant: u32,
    #[serde(default)]
    pub(super) signals: Vec<SignalName>,
}

#[derive(Debug, Deserialize)]
pub(super) struct SignalName {
    name: String,
    #[serde(default)]
    unit: String,
}

impl From<SignalName> for Signal {
    fn from(signal: SignalName) -> Self {
        Self { name: printable(&signal.name).into(), unit: printable(&signal.unit).into() }
    }
}

/// The bench's line of a step.
#[derive(Debug, Serialize)]
pub(super) struct Step {
    /// Torque that is held at the motor.
    pub(super) torque_nm: f64,
    /// Time for which it is held; a period may be split.
    pub(super) dt_s: f64,
}

/// The process's state after a step.
#[derive(Debug, Default, Deserialize)]
pub(super) struct State {
    pub(super) motor_position_rad: f64,
    pub(super) load_position_rad: f64,
    /// In the order of the signals.
    #[serde(default)]
    pub(super) values: Vec<f64>,
}

/// A line by which the process ends the run.
#[derive(Debug, Deserialize)]
pub(super) struct Report {
    pub(super) error: String,
}
