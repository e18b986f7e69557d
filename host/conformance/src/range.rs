//! The ranges of parameters, as the drive describes them.

use super::assertion::{Failure, broken, preparation};
use super::client::Client;
use super::words::Words;
use crate::prelude::wire::*;

/// Bytes of types without a name.
const UNKNOWN_TYPES: [u8; 3] = [3, 0x81, u8::MAX];

/// Most indices that a drive does not have of those that are tried, but for the last.
const MOST_UNKNOWN: usize = 11;

/// Indices that a drive does not have, spread from its count of them to the last.
pub(super) fn beyond(client: &Client, count: u8, last: u8) -> Vec<u8> {
    let free = usize::from(last.saturating_sub(count)) + 1;
    let step = free.div_ceil(client.repetitions(MOST_UNKNOWN));
    // Of seven bits the indices 128 and 129 would be 0 and 1.
    let spread = (count..=last).step_by(step).chain([128, 129, last]);
    spread.filter(|index| (count..=last).contains(index)).collect()
}

/// Whether a value has the type of a parameter and lies within its range.
pub(super) fn holds(parameter: &Parameter, value: ParameterValue) -> bool {
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
        (U32(min), U32(max)) => Ok(wished.max(min).min(max)),
        (F32(min), F32(max)) => Ok((wished as f32).max(min.ceil()).min(max.floor()) as u32),
        range => Err(broken(format!("{}: min and max of one type", parameter.name), range.words())),
    };
    preparation(format!("the range of {}", parameter.name), nearest)
}

/// The value nearest to `wished` in the range of a real parameter.
pub(super) fn nearest_real(parameter: &Parameter, wished: f32) -> Result<f32, Failure> {
    let nearest = match (parameter.min, parameter.max) {
        (F32(min), F32(max)) => Ok(wished.max(min).min(max)),
        range => Err(broken(format!("{}: min and max of type F32", parameter.name), range.words())),
    };
    preparation(format!("the range of {}", parameter.name), nearest)
}

/// An integer as a value of the parameter's type; any other value as it is.
pub(super) fn in_type_of(parameter: &Parameter, value: ParameterValue) -> ParameterValue {
    match (parameter.default, value) {
        (F32(_), U32(whole)) => F32(whole as f32),
        _ => value,
    }
}

/// Values outside the range: the nearest, those that another width or sign of integer maps into it, infinities and NaN.
pub(super) fn outside(parameter: &Parameter) -> Vec<ParameterValue> {
    match (parameter.min, parameter.max) {
        (U32(min), U32(max)) => {
            let nearest =
                [min.checked_sub(1), max.checked_add(1), min.checked_add(1 << 8), min.checked_add(1 << 16)];
            let default = if let U32(value) = parameter.default { value } else { 0 };
            let large = [1 << 31 | default, u32::MAX];
            let mut values: Vec<_> = nearest.into_iter().flatten().chain(large).collect();
            values.retain(|value| !(min..=max).contains(value));
            values.into_iter().map(U32).collect()
        }
        (F32(min), F32(max)) => {
            let nan = [f32::NAN, -f32::NAN, f32::from_bits(0x7f80_0001)];
            let infinite = [f32::NEG_INFINITY, f32::INFINITY];
            let outside = [min.next_down(), max.next_up(), -max].into_iter().chain(infinite).chain(nan);
            outside.filter(|value| !(min..=max).contains(value)).map(F32).collect()
        }
        _ => Vec::new(),
    }
}

/// The number and the bits of the default as the other type, and its bits as types that no parameter has.
pub(super) fn of_other_type(parameter: &Parameter) -> Vec<ParameterValue> {
    use ParameterValue::Unknown;
    let (mut values, bits) = match parameter.default {
        U32(value) => (vec![F32(value as f32), F32(f32::from_bits(value))], value),
        F32(value) => (vec![U32(value as u32), U32(value.to_bits())], value.to_bits()),
        Unknown { .. } => (vec![U32(0), F32(0.0)], 0),
    };
    values.extend(UNKNOWN_TYPES.into_iter().filter_map(|byte| match ParameterType::from_byte(byte) {
        Some(ParameterType::Unknown(ty)) => Some(Unknown { ty, bytes: bits.to_le_bytes() }),
        _ => None,
    }));
    values
}

/// A value next to the default; the default if the range holds no other.
pub(super) fn neighbour(parameter: &Parameter) -> ParameterValue {
    let candidates = match parameter.default {
        U32(value) => [value.checked_add(1), value.checked_sub(1)].map(|value| value.map(U32)),
        // No denormal number: a floating-point unit may flush it to zero.
        F32(0.0) => [1e-3, -1e-3].map(|value| Some(F32(value))),
        F32(value) => [value.next_up(), value.next_down()].map(|value| Some(F32(value))),
        ParameterValue::Unknown { .. } => [None, None],
    };
    candidates.into_iter().flatten().find(|value| holds(parameter, *value)).unwrap_or(parameter.default)
}

/// The value at this fraction of the range, or the default if the range has no such value.
pub(super) fn within(parameter: &Parameter, fraction: f64) -> ParameterValue {
    let between = |min: f64, max: f64| min + fraction * (max - min);
    let value = match (parameter.min, parameter.max) {
        (U32(min), U32(max)) => U32(between(min.into(), max.into()).round() as u32),
        (F32(min), F32(max)) => F32(between(min.into(), max.into()) as f32),
        _ => parameter.default,
    };
    if holds(parameter, value) { value } else { parameter.default }
}
