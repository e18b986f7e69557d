//! Numbers and units as a book prints them. How many digits a number gets is [`lashloop_bench::number`]'s.

use std::fmt::Display;

use lashloop_bench::number::{Apart, Shown};

/// A value.
pub(super) fn shown(value: f64) -> String {
    typeset(Shown(value))
}

/// A value next to its bounds.
pub(super) fn apart(value: f64, min: Option<f64>, max: Option<f64>) -> String {
    typeset(Apart::new(value, min, max))
}

/// A fraction in percent, as far as a reader compares it.
pub(super) fn percent(fraction: f64) -> String {
    let percent = fraction * 100.0;
    let number = match percent.abs() {
        0.0..9.95 => format!("{percent:.1}"),
        9.95..1e5 => format!("{percent:.0}"),
        _ => format!("{percent:.1e}"),
    };
    format!("{}\u{202f}%", typeset(number))
}

/// A unit: raised powers, and a true micro.
pub(super) fn unit(unit: &str) -> String {
    let unit = unit.replace("^2", "\u{b2}").replace("^3", "\u{b3}");
    if unit == "us" { "\u{b5}s".to_owned() } else { unit }
}

/// A true minus, and raised powers of ten.
fn typeset(number: impl Display) -> String {
    let number = number.to_string();
    let Some((mantissa, exponent)) = number.split_once('e') else { return number.replace('-', "\u{2212}") };
    let raised = exponent.chars().map(|digit| match digit {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        digit => digit.to_digit(10).and_then(|it| char::from_u32(0x2070 + it)).unwrap_or(digit),
    });
    format!("{}\u{202f}\u{d7}\u{202f}10{}", mantissa.replace('-', "\u{2212}"), raised.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_ten_are_raised_and_minus_is_no_hyphen() {
        assert_eq!(shown(-1.218e-6), "\u{2212}1.218\u{202f}\u{d7}\u{202f}10\u{207b}\u{2076}");
        assert_eq!(shown(-5.104), "\u{2212}5.104");
        assert_eq!(unit("N^2 m^2 s"), "N\u{b2} m\u{b2} s");
        assert_eq!(unit("us"), "\u{b5}s");
    }

    #[test]
    fn percentages_have_two_or_three_digits() {
        for (fraction, text) in
            [(0.32, "32"), (0.021_4, "2.1"), (-3.07, "\u{2212}307"), (0.0997, "10"), (0.0, "0.0")]
        {
            assert_eq!(percent(fraction), format!("{text}\u{202f}%"));
        }
    }
}
