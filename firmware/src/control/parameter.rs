//! What is said when a parameter can't be used.

use crate::control::Real;

/// A parameter outside its allowed range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("control parameter {name} is {value}, allowed is {low} to {high}")]
pub struct ParameterError {
    /// Name of the parameter, with its unit.
    pub name: &'static str,
    /// The value given.
    pub value: f32,
    /// Smallest allowed value.
    pub low: f32,
    /// Largest allowed value.
    pub high: f32,
}

/// Passes a parameter on if it lies in `low..=high`; NaN lies nowhere.
///
/// The bounds are single precision, so that a microcontroller compares them in hardware.
pub(crate) fn within<F: Real>(
    name: &'static str,
    value: F,
    low: f32,
    high: f32,
) -> Result<(), ParameterError> {
    if (F::from_f32(low)..=F::from_f32(high)).contains(&value) {
        Ok(())
    } else {
        Err(ParameterError { name, value: value.to_f64() as f32, low, high })
    }
}

/// Name, smallest and largest value of one of several parameters.
pub(crate) type Limits = (&'static str, f32, f32);

/// Checks as many values as there are limits, in their order. A loop, because the same written out costs the image
/// three times its size.
pub(crate) fn all_within<F: Real, const N: usize>(
    limits: &[Limits; N],
    values: [F; N],
) -> Result<(), ParameterError> {
    limits.iter().zip(values).try_for_each(|(&(name, low, high), value)| within(name, value, low, high))
}

/// Largest feedback gain of any loop, in its own unit: far above what a 1 kHz loop can carry, so only a slip of the
/// pen gets there.
pub(crate) const GAIN_MAX: f32 = 1e6;

/// Range of the control period in seconds: 10 us to 1 s.
pub(crate) const PERIOD_S: (f32, f32) = (1e-5, 1.0);
