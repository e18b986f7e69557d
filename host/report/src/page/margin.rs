//! How far a value is from its bounds.

use lashloop_campaign::suite::check::Check;

/// Distance of a value from the nearest bound; negative outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margin {
    /// In the unit of the value.
    pub distance: f64,
    /// Relative to the bound, between two bounds to their distance; `None` for the single bound 0.
    pub fraction: Option<f64>,
}

impl Margin {
    /// Of a value between bounds; `None` without a bound.
    #[must_use]
    pub fn of(value: f64, min: Option<f64>, max: Option<f64>) -> Option<Self> {
        let (distance, scale) = match (min, max) {
            (Some(min), Some(max)) => ((value - min).min(max - value), max - min),
            (Some(min), None) => (value - min, min.abs()),
            (None, Some(max)) => (max - value, max.abs()),
            (None, None) => return None,
        };
        Some(Self { distance, fraction: (scale > 0.0).then(|| distance / scale) })
    }

    pub(super) fn of_check(check: &Check) -> Option<Self> {
        Self::of(check.value?, check.min, check.max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_margin_is_the_distance_to_the_nearest_bound() {
        assert_eq!(
            Margin::of(4.5, Some(4.0), Some(6.0)),
            Some(Margin { distance: 0.5, fraction: Some(0.25) })
        );
        assert_eq!(
            Margin::of(7.0, Some(4.0), Some(6.0)),
            Some(Margin { distance: -1.0, fraction: Some(-0.5) })
        );
        assert_eq!(Margin::of(0.5, Some(0.0), None), Some(Margin { distance: 0.5, fraction: None }));
        assert_eq!(Margin::of(0.5, None, None), None);
    }
}
