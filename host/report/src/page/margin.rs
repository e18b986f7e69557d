//! How far a value is from its bounds.

use lashloop_campaign::suite::check::Check;

/// Below this fraction a margin is marginal.
const MARGINAL: f64 = 0.1;

/// The result of an expectation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grade {
    /// Met with a margin.
    Pass,
    /// Met with a margin below 10 % of the bound, or of the width between two bounds.
    Marginal,
    /// Not met, or without a value.
    Fail,
}

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

impl Grade {
    pub(super) fn of_check(check: &Check) -> Self {
        Self::of(check.ok, Margin::of_check(check))
    }

    /// Of a value that is met or not.
    pub(super) fn of(ok: bool, margin: Option<Margin>) -> Self {
        match margin.and_then(|margin| margin.fraction) {
            _ if !ok => Self::Fail,
            Some(fraction) if fraction < MARGINAL => Self::Marginal,
            _ => Self::Pass,
        }
    }

    /// Name in tables and class in the style.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Marginal => "marginal",
            Self::Fail => "fail",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grade(value: Option<f64>, min: Option<f64>, max: Option<f64>) -> Grade {
        let ok = value.is_some_and(|it| min.is_none_or(|min| it >= min) && max.is_none_or(|max| it <= max));
        Grade::of(ok, value.and_then(|value| Margin::of(value, min, max)))
    }

    #[test]
    fn a_margin_below_a_tenth_of_the_bound_is_marginal() {
        for (value, min, max, want) in [
            (Some(5.0), None, Some(6.0), Grade::Pass),
            (Some(5.5), None, Some(6.0), Grade::Marginal),
            (Some(6.0), None, Some(6.0), Grade::Marginal),
            (Some(6.1), None, Some(6.0), Grade::Fail),
            (Some(5.2), Some(5.0), Some(6.0), Grade::Pass),
            (Some(5.95), Some(5.0), Some(6.0), Grade::Marginal),
            (Some(-2.0), Some(-2.1), None, Grade::Marginal),
            (Some(0.5), Some(0.0), None, Grade::Pass),
            (None, None, Some(6.0), Grade::Fail),
        ] {
            assert_eq!(grade(value, min, max), want, "{value:?} in {min:?} to {max:?}");
        }
    }

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
