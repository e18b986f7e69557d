//! Numbers of a table as text, with the digits that they deserve.

use std::io::Write;

/// Digits of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// As many as read back to the same bits.
    Exact,
    /// At most this number of digits behind the point.
    Decimals(u8),
    /// At least this number of digits, from the first that isn't zero.
    Significant(u8),
}

/// Beyond it, not every whole number is an `f64`.
const LARGEST_WHOLE: f64 = 9e15;
/// Further decimals are written with an exponent.
const MOST_DECIMALS: i32 = 9;

impl Digits {
    /// Appends a number without zeros at its end; nothing for NaN.
    pub fn push(self, value: f64, text: &mut Vec<u8>) {
        match self {
            _ if value.is_nan() => {}
            Self::Exact => exact(value, text),
            Self::Decimals(count) => fixed(value, count.into(), text),
            Self::Significant(_) if value == 0.0 => text.push(b'0'),
            Self::Significant(count) => match i32::from(count) - 1 - value.abs().log10().floor() as i32 {
                decimals if decimals > MOST_DECIMALS => {
                    // A Vec takes every byte.
                    let _ = write!(text, "{value:.*e}", usize::from(count) - 1);
                }
                decimals => fixed(value, decimals.max(0), text),
            },
        }
    }
}

fn exact(value: f64, text: &mut Vec<u8>) {
    text.extend_from_slice(zmij::Buffer::new().format(value).as_bytes());
}

fn fixed(value: f64, decimals: i32, text: &mut Vec<u8>) {
    let scaled = (value * 10_f64.powi(decimals)).round();
    if scaled.is_nan() || scaled.abs() >= LARGEST_WHOLE {
        return exact(value, text);
    }
    let (scaled, unit) = (scaled as i64, 10_i64.pow(decimals.unsigned_abs()));
    let sign = if scaled < 0 { "-" } else { "" };
    let _ = write!(text, "{sign}{}", (scaled / unit).abs());
    let mut rest = (scaled % unit).abs();
    if rest == 0 {
        return;
    }
    let mut width = decimals.unsigned_abs() as usize;
    while rest % 10 == 0 {
        rest /= 10;
        width -= 1;
    }
    let _ = write!(text, ".{rest:0width$}");
}

#[cfg(test)]
mod tests {
    use super::Digits::{self, Decimals, Exact, Significant};

    fn text(digits: Digits, value: f64) -> String {
        let mut text = Vec::new();
        digits.push(value, &mut text);
        String::from_utf8(text).expect("a number in ASCII")
    }

    #[test]
    fn numbers_have_their_digits_and_no_zeros_at_the_end() {
        for (digits, value, want) in [
            (Exact, 0.1 + 0.2, "0.30000000000000004"),
            (Decimals(5), 0.000_004, "0"),
            (Decimals(5), -0.000_004, "0"),
            (Decimals(5), -0.05, "-0.05"),
            (Decimals(5), 1.020_004, "1.02"),
            (Decimals(0), -8_388_608.0, "-8388608"),
            (Decimals(6), 1e300, "1e+300"),
            (Decimals(3), f64::NAN, ""),
            (Significant(5), 0.0, "0"),
            (Significant(5), 123_456.7, "123457"),
            (Significant(5), 9.999_996, "10"),
            (Significant(5), -0.012_345_67, "-0.012346"),
            (Significant(5), 2.802_596_928_6e-45, "2.8026e-45"),
            (Significant(2), 15.053, "15"),
            (Significant(5), f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(text(digits, value), want, "{value} with {digits:?}");
        }
    }

    #[test]
    fn a_rounded_number_reads_back_within_half_of_its_last_digit() {
        for step in 0..10_000 {
            let value = (f64::from(step) * 0.7).sin() * 10_f64.powi(step % 7 - 3);
            let read = |digits| text(digits, value).parse::<f64>().expect("a number");
            assert!((read(Decimals(5)) - value).abs() <= 0.500_001e-5, "{value}");
            assert!((read(Significant(5)) - value).abs() <= 0.500_001e-4 * value.abs(), "{value}");
        }
    }
}
