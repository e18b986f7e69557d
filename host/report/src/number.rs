//! Numbers with the digits that they deserve.

/// Digits of a measured value: the metrics of one scenario differ by more than a hundredth of a percent on other machines.
pub const DIGITS: usize = 4;

/// A value rounded to significant digits, trailing zeros included: `5.104`, `0.001437`, `-1.218e-4`. Powers of ten are used below
/// 1e-3 and from 1e7 on.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    let last = digits.max(1) - 1;
    let scientific = format!("{value:.last$e}");
    let exponent = scientific.rsplit_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    match exponent {
        Some(exponent @ -3..=6) => {
            let decimals = usize::try_from(last as i32 - exponent).unwrap_or(0);
            format!("{value:.decimals$}")
        }
        _ => scientific,
    }
}

/// A bound that a person has set: as short as it can be without another value.
#[must_use]
pub fn exact(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        1e-4..1e9 => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// A number as a book prints it: a true minus, and powers of ten raised.
#[must_use]
pub fn typeset(number: &str) -> String {
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

/// A unit as a book prints it: raised powers, and a true micro.
#[must_use]
pub fn typeset_unit(unit: &str) -> String {
    let unit = unit.replace("^2", "\u{b2}").replace("^3", "\u{b3}");
    if unit == "us" { "\u{b5}s".to_owned() } else { unit }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_has_its_significant_digits_at_every_magnitude() {
        for (value, text) in [
            (5.104, "5.104"),
            (0.0014368937565570371, "0.001437"),
            (-0.00012179286708966132, "-1.218e-4"),
            (760.6193922384991, "760.6"),
            (20.420663833618164, "20.42"),
            (99_995.0, "99995"),
            (9.9999, "10.00"),
            (0.0, "0"),
            (-0.0, "0"),
            (12_345_678.0, "1.235e7"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(significant(value, DIGITS), text);
        }
    }

    #[test]
    fn a_bound_keeps_the_digits_of_its_author() {
        for (value, text) in [(5.24, "5.24"), (0.0, "0"), (-0.015, "-0.015"), (1e-6, "1e-6"), (30_000.0, "30000")] {
            assert_eq!(exact(value), text);
        }
    }

    #[test]
    fn powers_of_ten_are_raised_and_minus_is_no_hyphen() {
        assert_eq!(typeset("-1.218e-4"), "\u{2212}1.218\u{202f}\u{d7}\u{202f}10\u{207b}\u{2074}");
        assert_eq!(typeset("-5.104"), "\u{2212}5.104");
        assert_eq!(typeset_unit("N^2 m^2 s"), "N\u{b2} m\u{b2} s");
        assert_eq!(typeset_unit("us"), "\u{b5}s");
    }
}
