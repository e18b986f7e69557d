//! Errors of plants and encoders.

use std::ops::RangeInclusive;

use crate::limits::{MAX_COORDINATE, MAX_EVENTS, MAX_SIGNALS, MAX_SUBSTEPS};

/// A parameter outside its allowed range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("parameter {name} of the simulated plant is {value}, allowed is {low} to {high}")]
pub struct ParameterError {
    /// Name of the parameter, with its unit.
    pub name: &'static str,
    /// The rejected value.
    pub value: f64,
    /// Smallest allowed value.
    pub low: f64,
    /// Largest allowed value.
    pub high: f64,
}

/// Checks that a parameter lies in `low..=high`. NaN is rejected.
pub(crate) fn within(name: &'static str, value: f64, low: f64, high: f64) -> Result<(), ParameterError> {
    if (low..=high).contains(&value) { Ok(()) } else { Err(ParameterError { name, value, low, high }) }
}

/// Checks a parameter against its range.
pub(crate) fn in_range(
    name: &'static str,
    value: f64,
    range: &RangeInclusive<f64>,
) -> Result<(), ParameterError> {
    within(name, value, *range.start(), *range.end())
}

/// Checks a number of substeps, 1 to [`MAX_SUBSTEPS`].
pub(crate) fn validate_substeps(substeps: u32) -> Result<(), ParameterError> {
    within("substeps", f64::from(substeps), 1.0, f64::from(MAX_SUBSTEPS))
}

/// Why a plant can't be built, or rejected a step or a change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlantError {
    /// The user has interrupted the program while it waited for the plant.
    #[error("INVALID: interrupted by the user while the bench waited for the plant's process")]
    Interrupted,
    /// The torque is NaN or infinite.
    #[error("plant was given a torque of {torque_nm} N m, needs a finite one")]
    Torque {
        /// The rejected torque.
        torque_nm: f64,
    },
    /// The duration is negative, NaN or infinite.
    #[error("plant was given a step of {dt_s} s, needs a finite one of at least 0")]
    Duration {
        /// The rejected duration.
        dt_s: f64,
    },
    /// Contact or sticking changes without end.
    #[error(
        "plant is chattering: more than {limit} changes of contact or sticking within one substep of {substep_s} s; \
         use more substeps or check the parameters",
        limit = MAX_EVENTS
    )]
    Chattering {
        /// Length of the substep that did not end.
        substep_s: f64,
    },
    /// The plant is too fast for the step, even with the largest allowed number of substeps.
    #[error(
        "plant is too stiff: a step of {dt_s} s would need {needed} substeps, at most {limit} are allowed; \
         make the shaft or the bristles softer, the inertias larger or the control period shorter",
        limit = MAX_SUBSTEPS
    )]
    TooStiff {
        /// Substeps that stability needs.
        needed: f64,
        /// Length of the step.
        dt_s: f64,
    },
    /// A coordinate became NaN or larger than [`MAX_COORDINATE`].
    #[error(
        "plant state left the range of +-{limit:e} after a torque of {torque_nm} N m; use more substeps or check the parameters",
        limit = MAX_COORDINATE
    )]
    NotFinite {
        /// Torque of the step that diverged.
        torque_nm: f64,
    },
    /// A parameter or a value of the environment is outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The plant's environment and parameters are fixed.
    #[error(
        "this plant takes no load torque, wear or change of parameters; use the backlash-shaft plant for them"
    )]
    FixedEnvironment,
    /// A plant asked for a value that its keys don't give.
    #[error(
        "key {key} of the simulated plant has no {kind}; declare it in the model's keys, or give it in [plant]"
    )]
    NoValue {
        /// The key.
        key: &'static str,
        /// The kind of value.
        kind: &'static str,
    },
    /// The record does not hold this number of signals.
    #[error("the plant has {have} signals, at most {limit} are allowed; leave some out", limit = MAX_SIGNALS)]
    TooManySignals {
        /// Signals of the plant.
        have: usize,
    },
    /// Two columns of the record would have one name.
    #[error(
        "the plant has a signal {name:?}, but a column of the record has this name already; rename the signal"
    )]
    SignalName {
        /// The name.
        name: String,
    },
    /// The plant failed for a reason of its own, which says what to do. It judges no drive.
    #[error("{0}")]
    Failed(String),
}
