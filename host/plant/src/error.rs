//! What a plant refuses.

use crate::backlash_shaft::MAX_SUBSTEPS;
use crate::integrator::MAX_EVENTS;

/// A parameter outside its allowed range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("plant parameter {name} is {value}, allowed is {low} to {high}")]
pub struct ParameterError {
    /// Name of the parameter, with its unit.
    pub name: &'static str,
    /// The value given.
    pub value: f64,
    /// Smallest allowed value.
    pub low: f64,
    /// Largest allowed value.
    pub high: f64,
}

/// Checks that a parameter lies in `low..=high`; NaN lies nowhere.
pub(crate) fn within(name: &'static str, value: f64, low: f64, high: f64) -> Result<(), ParameterError> {
    if (low..=high).contains(&value) { Ok(()) } else { Err(ParameterError { name, value, low, high }) }
}

/// Why a plant could not take a step.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PlantError {
    /// The torque is NaN or infinite.
    #[error("plant was given a torque of {torque_nm} N m, needs a finite one")]
    Torque {
        /// The torque given.
        torque_nm: f64,
    },
    /// The duration is negative, NaN or infinite.
    #[error("plant was given a step of {dt_s} s, needs a finite one of at least 0")]
    Duration {
        /// The duration given.
        dt_s: f64,
    },
    /// Contact or sticking changes without end.
    #[error(
        "plant is chattering: more than {limit} changes of contact or sticking within one substep of {substep_s} s; \
         use more substeps or check the parameters",
        limit = MAX_EVENTS
    )]
    Chattering {
        /// Length of the substep in which it happened.
        substep_s: f64,
    },
    /// The plant is too fast for the step, whatever the allowed number of substeps.
    #[error(
        "plant is too stiff: a step of {dt_s} s would need {needed} substeps, at most {limit} are allowed; \
         make the shaft or the bristles softer, the inertias larger or the control period shorter",
        limit = MAX_SUBSTEPS
    )]
    TooStiff {
        /// Substeps it would need.
        needed: f64,
        /// Length of the step.
        dt_s: f64,
    },
    /// A coordinate became NaN or infinite.
    #[error(
        "plant state is no longer finite after a torque of {torque_nm} N m; use more substeps or check the parameters"
    )]
    NotFinite {
        /// Torque of the step in which it happened.
        torque_nm: f64,
    },
    /// A value around the plant is outside its range.
    #[error(transparent)]
    Environment(#[from] ParameterError),
    /// The profile takes no load torque and its gap does not wear.
    #[error("a {plant} plant has no load torque and no wear; use the bench profile for them")]
    FixedSurroundings {
        /// AnyPlant of the plant.
        plant: &'static str,
    },
    /// The state belongs to another profile.
    #[error("state belongs to a {state} plant, this one is {plant}; start from its own initial state")]
    ForeignState {
        /// AnyPlant of the state.
        state: &'static str,
        /// AnyPlant of the plant.
        plant: &'static str,
    },
}
