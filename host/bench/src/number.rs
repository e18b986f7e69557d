//! Numbers with the digits that a reader needs: five significant ones. Files keep full precision.

use std::fmt;

/// Significant digits. An encoder of 2^17 counts resolves a revolution to five and a fraction.
const DIGITS: usize = 5;
/// Digits that distinguish any two doubles.
const ALL_DIGITS: usize = 17;
/// Powers of ten that are written as plain decimals.
const PLAIN: std::ops::RangeInclusive<i32> = -4..=6;

/// A number as a report prints it: `0.0014369`, `13`, `4.2e-9`. An integer below 10^7 keeps all its digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown(pub f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&text(self.0, DIGITS))
    }
}

/// A number next to its bounds, with as many more digits as it takes to be on its side of a bound that it does not equal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Apart {
    value: f64,
    bounds: [Option<f64>; 2],
}

impl Apart {
    /// A value and its bounds.
    #[must_use]
    pub fn new(value: f64, min: Option<f64>, max: Option<f64>) -> Self {
        Self { value, bounds: [min, max] }
    }
}

impl fmt::Display for Apart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_apart = |digits: &usize| {
            let shown: f64 = text(self.value, *digits).parse().unwrap_or(f64::NAN);
            let mut bounds = self.bounds.iter().flatten();
            bounds.all(|bound| {
                *bound == self.value || shown.partial_cmp(bound) == self.value.partial_cmp(bound)
            })
        };
        let digits = (DIGITS..ALL_DIGITS).find(is_apart).unwrap_or(ALL_DIGITS);
        f.pad(&text(self.value, digits))
    }
}

/// A number with six significant digits, for comparisons.
#[must_use]
pub fn figure(value: f64) -> String {
    text(value, 6)
}

/// The value of six significant digits nearest to a value: of a case, of a baseline. Their rounding is far below any tolerance
/// of ours.
#[must_use]
pub fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

fn text(value: f64, digits: usize) -> String {
    if !value.is_finite() || value == 0.0 {
        // Adding zero turns minus zero into zero.
        return format!("{}", value + 0.0);
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    // The exponent after rounding: 99999.7 has that of 100000.
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if !PLAIN.contains(&exponent) {
        return format!("{}e{exponent}", trimmed(mantissa));
    }
    let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
    trimmed(&format!("{value:.decimals$}")).to_owned()
}

fn trimmed(decimal: &str) -> &str {
    if decimal.contains('.') { decimal.trim_end_matches('0').trim_end_matches('.') } else { decimal }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_significant_digits_are_shown() {
        for (value, shown) in [
            (0.001_436_893_756_557_037_1, "0.0014369"),
            (13.0, "13"),
            (25.001, "25.001"),
            (-0.16, "-0.16"),
            (99_999.7, "100000"),
            (1_234_567.8, "1234568"),
            (4.2e-9, "4.2e-9"),
            (-6.022_140_76e23, "-6.0221e23"),
            (-0.0, "0"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Shown(value).to_string(), shown);
        }
        assert_eq!(format!("[{:>9}]", Shown(1.5)), "[      1.5]");
    }

    #[test]
    fn a_value_of_a_file_has_six_significant_digits() {
        for (value, rounded) in
            [(0.001_436_893_756, 0.001_436_89), (-12_345_678.9, -12_345_700.0), (0.1 + 0.2, 0.3)]
        {
            assert_eq!(six_digits(value), rounded);
        }
        assert!(six_digits(f64::NAN).is_nan());
    }

    #[test]
    fn a_value_just_beyond_its_bound_differs_from_it_in_print() {
        let shown = |value, max| Apart::new(value, None, Some(max)).to_string();
        assert_eq!(shown(5.000_000_1, 5.0), "5.0000001");
        assert_eq!(shown(5.0, 5.0), "5");
        assert_eq!(shown(4.2, 5.0), "4.2");
        assert_eq!(shown(1.234_645, 1.234_642), "1.234645");
        assert_eq!(shown(0.1 + 0.2, 0.3), "0.30000000000000004");
    }
}
