//! The values of one telemetry message: as many as the host subscribed to.

use core::fmt;

use crate::layout::FieldType;
use crate::limits::MAX_TELEMETRY_VALUES;
use crate::wire::Wire;

/// Length of a value, in bytes.
const ELEMENT_LEN: usize = size_of::<f32>();

/// Values of 1 to [`MAX_TELEMETRY_VALUES`] signals, inline.
#[derive(Clone, Copy)]
pub struct TelemetryValues {
    values: [f32; MAX_TELEMETRY_VALUES],
    /// Number of values in use, at least 1.
    count: u8,
}

impl TelemetryValues {
    /// The values; `None` if there are none, or more than a frame holds.
    #[inline]
    #[must_use]
    pub fn new(values: &[f32]) -> Option<Self> {
        let mut this = Self { values: [0.0; MAX_TELEMETRY_VALUES], count: values.len() as u8 };
        if values.is_empty() {
            return None;
        }
        this.values.get_mut(..values.len())?.copy_from_slice(values);
        Some(this)
    }

    /// The values, in ascending order of the signals' indices.
    #[inline]
    #[must_use]
    pub fn as_slice(&self) -> &[f32] {
        &self.values[..usize::from(self.count)]
    }
}

impl PartialEq for TelemetryValues {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl fmt::Debug for TelemetryValues {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_slice().fmt(out)
    }
}

impl Wire for TelemetryValues {
    const LEN: usize = MAX_TELEMETRY_VALUES * ELEMENT_LEN;
    const ELEMENT_LEN: Option<usize> = Some(ELEMENT_LEN);
    const TYPE: FieldType = FieldType::F32Repeated;

    #[inline]
    fn byte_len(self) -> usize {
        usize::from(self.count) * ELEMENT_LEN
    }

    #[inline]
    fn put(self, out: &mut [u8]) {
        for (bytes, value) in out.as_chunks_mut::<ELEMENT_LEN>().0.iter_mut().zip(self.values) {
            *bytes = value.to_le_bytes();
        }
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        let (elements, []) = bytes.as_chunks::<ELEMENT_LEN>() else { return None };
        let mut this = Self { values: [0.0; MAX_TELEMETRY_VALUES], count: elements.len() as u8 };
        if elements.is_empty() {
            return None;
        }
        for (value, element) in this.values.get_mut(..elements.len())?.iter_mut().zip(elements) {
            *value = f32::from_le_bytes(*element);
        }
        Some(this)
    }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use super::*;

    #[test]
    fn one_to_thirteen_values_fit() {
        for count in 0..20_usize {
            let values: Vec<f32> = (0..count).map(|at| 0.5 + at as f32).collect();
            let made = TelemetryValues::new(&values);
            assert_eq!(made.is_some(), (1..=13).contains(&count), "{count} values");
            if let Some(made) = made {
                assert_eq!(made.as_slice(), values);
                assert_eq!(made.byte_len(), 4 * count);
            }
        }
    }

    #[test]
    fn bytes_are_whole_values() {
        for len in 0..=60 {
            let got = TelemetryValues::get(&vec![0x40; len]);
            assert_eq!(got.is_some(), len % 4 == 0 && (4..=52).contains(&len), "{len} bytes");
        }
        let bytes = [0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0];
        let two = TelemetryValues::get(&bytes).expect("two values");
        assert_eq!(two.as_slice(), [1.0, -2.0]);
        let mut put = [0x55; 8];
        two.put(&mut put);
        assert_eq!(put, bytes);
    }

    #[test]
    fn values_beyond_the_count_do_not_make_a_difference() {
        let three = TelemetryValues::get(&[0x3f; 12]).expect("three values");
        let two = TelemetryValues { count: 2, ..three };
        assert_eq!(Some(two), TelemetryValues::new(&three.as_slice()[..2]));
        assert_ne!(two, three);
    }
}
