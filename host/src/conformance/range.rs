//! The ranges of parameters, as the drive describes them.

use lashloop_bench::session::Parameter;
use lashloop_protocol::enums::ParameterValue;

use super::assertion::Failure;

/// Whether a value lies in the range of a parameter and is of its type.
pub(super) fn holds(parameter: &Parameter, value: ParameterValue) -> bool {
    use ParameterValue::{F32, U32};
    match (parameter.min, value, parameter.max) {
        (U32(min), U32(value), U32(max)) => (min..=max).contains(&value),
        (F32(min), F32(value), F32(max)) => (min..=max).contains(&value),
        _ => false,
    }
}

/// The value in the range of a whole parameter that is nearest to this one.
pub(super) fn nearest_whole(parameter: &Parameter, wished: u32) -> Result<u32, Failure> {
    match (parameter.min, parameter.max) {
        // A drive may say anything, even a range upside down, for which `clamp` would panic.
        (ParameterValue::U32(min), ParameterValue::U32(max)) => Ok(wished.max(min).min(max)),
        range => Err(Failure::Rule {
            expected: format!("{}: a range of whole numbers", parameter.name),
            came: format!("{range:?}"),
        }),
    }
}

/// The same for a real one.
pub(super) fn nearest_real(parameter: &Parameter, wished: f32) -> Result<f32, Failure> {
    match (parameter.min, parameter.max) {
        (ParameterValue::F32(min), ParameterValue::F32(max)) => Ok(wished.max(min).min(max)),
        range => Err(Failure::Rule {
            expected: format!("{}: a range of real numbers", parameter.name),
            came: format!("{range:?}"),
        }),
    }
}

/// The values next to the range, and those that are no numbers.
pub(super) fn outside(parameter: &Parameter) -> Vec<ParameterValue> {
    use ParameterValue::{F32, U32};
    match (parameter.min, parameter.max) {
        (U32(min), U32(max)) => {
            [min.checked_sub(1), max.checked_add(1)].into_iter().flatten().map(U32).collect()
        }
        (F32(min), F32(max)) => {
            let beside = [min.next_down(), max.next_up(), f32::NEG_INFINITY, f32::INFINITY, f32::NAN];
            beside.into_iter().filter(|value| !(min..=max).contains(value)).map(F32).collect()
        }
        _ => Vec::new(),
    }
}
