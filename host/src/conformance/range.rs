//! The ranges of parameters, as the drive describes them.

use lashloop_bench::session::Parameter;
use lashloop_protocol::enums::ParameterValue;

use super::assertion::{Failure, broken, preparation};
use super::words::Words;

/// Whether a value has the type of a parameter and lies within its range.
pub(super) fn holds(parameter: &Parameter, value: ParameterValue) -> bool {
    use ParameterValue::{F32, U32};
    match (parameter.min, value, parameter.max) {
        (U32(min), U32(value), U32(max)) => (min..=max).contains(&value),
        (F32(min), F32(value), F32(max)) => (min..=max).contains(&value),
        _ => false,
    }
}

/// The whole number nearest to `wished` in the range of a parameter of either type.
pub(super) fn nearest_whole(parameter: &Parameter, wished: u32) -> Result<u32, Failure> {
    let nearest = match (parameter.min, parameter.max) {
        // A drive may describe an inverted range, on which `clamp` would panic.
        (ParameterValue::U32(min), ParameterValue::U32(max)) => Ok(wished.max(min).min(max)),
        (ParameterValue::F32(min), ParameterValue::F32(max)) => {
            Ok((wished as f32).max(min.ceil()).min(max.floor()) as u32)
        }
        range => Err(broken(format!("{}: min and max of one type", parameter.name), range.words())),
    };
    preparation(format!("the range of {}", parameter.name), nearest)
}

/// The value nearest to `wished` in the range of a real parameter.
pub(super) fn nearest_real(parameter: &Parameter, wished: f32) -> Result<f32, Failure> {
    let nearest = match (parameter.min, parameter.max) {
        (ParameterValue::F32(min), ParameterValue::F32(max)) => Ok(wished.max(min).min(max)),
        range => Err(broken(format!("{}: min and max of type F32", parameter.name), range.words())),
    };
    preparation(format!("the range of {}", parameter.name), nearest)
}

/// An integer as a value of the parameter's type; any other value as it is.
pub(super) fn in_type_of(parameter: &Parameter, value: ParameterValue) -> ParameterValue {
    match (parameter.default, value) {
        (ParameterValue::F32(_), ParameterValue::U32(whole)) => ParameterValue::F32(whole as f32),
        _ => value,
    }
}

/// Values just outside the range, infinities and NaN.
pub(super) fn outside(parameter: &Parameter) -> Vec<ParameterValue> {
    use ParameterValue::{F32, U32};
    match (parameter.min, parameter.max) {
        (U32(min), U32(max)) => {
            [min.checked_sub(1), max.checked_add(1)].into_iter().flatten().map(U32).collect()
        }
        (F32(min), F32(max)) => {
            let outside = [min.next_down(), max.next_up(), f32::NEG_INFINITY, f32::INFINITY, f32::NAN];
            outside.into_iter().filter(|value| !(min..=max).contains(value)).map(F32).collect()
        }
        _ => Vec::new(),
    }
}
