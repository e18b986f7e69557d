//! Parameters that don't go together.
//!
//! The range of a single parameter belongs to the drive's parameter table. Constructors of laws check only the limit
//! that one parameter sets to another.

use super::real::Real;

/// Relative difference of a value from a limit of the hardware that rounding to single precision explains.
pub const ROUNDING: f32 = 1e-6;

/// A parameter beyond the limit that other parameters set.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("control parameter {name} is {value}, allowed is at most {max}, given by {given_by}")]
pub struct ParameterError {
    /// Name of the parameter, with its unit.
    pub name: &'static str,
    /// Value of the parameter.
    pub value: f32,
    /// Largest value that goes with the other parameters.
    pub max: f32,
    /// What sets the largest value.
    pub given_by: &'static str,
}

impl ParameterError {
    /// Checks a parameter against a limit that other parameters set. NaN is beyond every limit.
    ///
    /// # Errors
    /// The value is beyond `max`. `given_by` names what sets `max`, as in "the control period".
    pub fn at_most<F: Real>(
        name: &'static str,
        value: F,
        max: F,
        given_by: &'static str,
    ) -> Result<(), Self> {
        if value <= max {
            Ok(())
        } else {
            Err(Self { name, value: value.to_f64() as f32, max: max.to_f64() as f32, given_by })
        }
    }
}
