//! The state of an instance, as a value and as bytes.

use serde::{Deserialize, Serialize};

use crate::error::ExportError;
use crate::plant::PlantState;
use crate::variable::Value;

/// The state of an instance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Of the FMU that it belongs to.
    pub(crate) token: String,
    pub(crate) phase: Phase,
    /// Start of the simulation in s, by its bits.
    pub(crate) start_bits: u64,
    pub(crate) at_ns: u64,
    pub(crate) values: Vec<Saved>,
    pub(crate) plant: Option<PlantState>,
}

/// Where an instance is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Phase {
    Instantiated,
    Initializing,
    Stepping,
    Terminated,
}

impl Phase {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Instantiated => "before the initialization",
            Self::Initializing => "in the initialization",
            Self::Stepping => "after the initialization",
            Self::Terminated => "after the end",
        }
    }
}

/// A value with all its bits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum Saved {
    Real(u64),
    Integer(i32),
    Boolean(bool),
    Text(String),
}

impl From<&Value> for Saved {
    fn from(value: &Value) -> Self {
        match value {
            Value::Real(number) => Self::Real(number.to_bits()),
            Value::Integer(number) => Self::Integer(*number),
            Value::Boolean(is_on) => Self::Boolean(*is_on),
            Value::Text(text) => Self::Text(text.clone()),
        }
    }
}

impl From<&Saved> for Value {
    fn from(saved: &Saved) -> Self {
        match saved {
            Saved::Real(bits) => Self::Real(f64::from_bits(*bits)),
            Saved::Integer(number) => Self::Integer(*number),
            Saved::Boolean(is_on) => Self::Boolean(*is_on),
            Saved::Text(text) => Self::Text(text.clone()),
        }
    }
}

impl Snapshot {
    /// The state as bytes, which another instance of the same FMU reads, in another process too.
    ///
    /// # Errors
    /// The state can't be written.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ExportError> {
        serde_json::to_vec(self).map_err(|_| ExportError::State("it can't be written"))
    }

    /// The state of these bytes.
    ///
    /// # Errors
    /// They aren't a state.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ExportError> {
        serde_json::from_slice(bytes).map_err(|_| ExportError::State("its bytes are something else"))
    }
}
