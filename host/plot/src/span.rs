//! The range of values that an axis shows.

/// Magnitude beyond which a difference may overflow; such a value is treated as non-finite.
const LARGEST: f64 = 1e300;

/// Magnitude below which a value is treated as zero: its ticks would need powers of ten that a double can't represent.
const SMALLEST: f64 = 1e-290;

/// Range, as a fraction of the magnitude, below which differences are rounding errors and tick labels would be equal.
const SMALLEST_SPREAD: f64 = 1e-9;

/// Whether a value can be drawn at all.
pub fn is_drawable(value: f64) -> bool {
    value.abs() < LARGEST
}

/// A range of values with `low < high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    pub low: f64,
    pub high: f64,
}

impl Span {
    /// The range of an axis without data.
    pub const UNIT: Self = Self { low: 0.0, high: 1.0 };

    /// The range of all drawable values, widened around a constant; `None` without a drawable value.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let (low, high) = values
            .filter(|value| is_drawable(*value))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if low > high {
            return None;
        }
        let magnitude = low.abs().max(high.abs());
        if magnitude < SMALLEST {
            return Some(Self { low: -1.0, high: 1.0 });
        }
        if high - low > SMALLEST_SPREAD * magnitude {
            return Some(Self { low, high });
        }
        Some(Self { low: low - 0.5 * magnitude, high: high + 0.5 * magnitude })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn non_finite_values_leave_the_range_unchanged() {
        let values = [f64::NAN, 1.0, f64::INFINITY, -2.0, f64::NEG_INFINITY, 1e301];
        assert_eq!(Span::of(values.into_iter()), Some(Span { low: -2.0, high: 1.0 }));
        assert_eq!(Span::of([f64::NAN].into_iter()), None);
    }

    #[test]
    fn constant_gets_a_margin_on_both_sides() {
        assert_eq!(Span::of([0.16, 0.16].into_iter()), Some(Span { low: 0.08, high: 0.24 }));
        assert_eq!(Span::of([0.0].into_iter()), Some(Span { low: -1.0, high: 1.0 }));
        assert_eq!(Span::of([-4.0, -4.0 - 1e-12].into_iter()).map(|span| span.low < -5.9), Some(true));
    }
}
