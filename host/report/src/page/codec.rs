//! Columns of numbers as short text for the script of a page.
//!
//! A value becomes an integer, `(value - offset) / scale` rounded; its first or second difference, whichever is shorter, becomes
//! a token, and a token becomes digits of 6 bits: 5 bits of the token, lowest first, and one bit for "more follow".
//!
//! | token | meaning |
//! |---|---|
//! | 0 | the value is not finite |
//! | 1, n | the difference before repeats n times more |
//! | 2 + zigzag(d) | the difference d |

use serde::Serialize;

/// Digits, by their value. None of them has a meaning in JSON, HTML or a script.
const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
const MORE: u64 = 32;
/// Steps between the smallest and the largest value, from fine to coarse. A curve is 10^3 pixels high, and a zoom magnifies by
/// 10^3 more; a page whose columns are all noise has less.
pub(super) const STEPS: [f64; 3] = [1_048_576.0, 65_536.0, 4_096.0];

/// Largest amount in a column whose range exceeds that of a number.
const LARGEST: f64 = f64::MAX / 4.0;

/// An encoded column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Encoded {
    offset: f64,
    scale: f64,
    /// 1 or 2: how often differences were taken.
    order: u8,
    digits: String,
}

impl Encoded {
    /// The values, rounded to `steps` steps of their range.
    pub(super) fn of(values: &[f64], steps: f64) -> Self {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let low = finite().fold(f64::INFINITY, f64::min);
        let high = finite().fold(f64::NEG_INFINITY, f64::max);
        let offset = if low.is_finite() { low } else { 0.0 };
        let span = high - low;
        if span == f64::INFINITY && low.is_finite() {
            // Neither the span nor a value from its low end has a number: such a curve is cut off above and below.
            let within =
                |value: &f64| if value.is_finite() { value.clamp(-LARGEST, LARGEST) } else { *value };
            return Self::of(&values.iter().map(within).collect::<Vec<_>>(), steps);
        }
        Self::scaled(values, offset, if span > 0.0 && span.is_finite() { span / steps } else { 1.0 })
    }

    /// Ascending times, rounded to 1 us.
    pub(super) fn of_times(times_s: &[f64]) -> Self {
        Self::scaled(times_s, times_s.first().copied().unwrap_or(0.0), 1e-6)
    }

    fn scaled(values: &[f64], offset: f64, scale: f64) -> Self {
        let encode = |order| Self { offset, scale, order, digits: digits(values, offset, scale, order) };
        let (once, twice) = (encode(1), encode(2));
        if once.digits.len() <= twice.digits.len() { once } else { twice }
    }

    /// Number of digits.
    pub(super) fn len(&self) -> usize {
        self.digits.len()
    }
}

/// Largest number of steps from the offset. A damaged record may have times of 1e300 s; the script counts up to here.
const FARTHEST: f64 = (1_u64 << 53) as f64;

fn digits(values: &[f64], offset: f64, scale: f64, order: u8) -> String {
    let mut text = String::with_capacity(values.len() * 2);
    let (mut last, mut slope) = (0_i64, 0_i64);
    let mut before = None;
    let mut repeats = 0;
    for value in values {
        if !value.is_finite() {
            push_repeats(&mut text, &mut repeats);
            push(&mut text, 0);
            before = None;
            continue;
        }
        let number = ((value - offset) / scale).round().clamp(-FARTHEST, FARTHEST) as i64;
        let first = number - last;
        let difference = if order == 1 { first } else { first - slope };
        (last, slope) = (number, first);
        if before == Some(difference) {
            repeats += 1;
            continue;
        }
        push_repeats(&mut text, &mut repeats);
        push(&mut text, 2 + zigzag(difference));
        before = Some(difference);
    }
    push_repeats(&mut text, &mut repeats);
    text
}

fn push_repeats(text: &mut String, repeats: &mut u64) {
    if *repeats > 0 {
        push(text, 1);
        push(text, *repeats);
        *repeats = 0;
    }
}

fn push(text: &mut String, mut token: u64) {
    while token >= MORE {
        text.push(char::from(DIGITS[(token % MORE + MORE) as usize]));
        token /= MORE;
    }
    text.push(char::from(DIGITS[token as usize]));
}

fn zigzag(difference: i64) -> u64 {
    ((difference << 1) ^ (difference >> 63)) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `report.js` decodes.
    fn decoded(column: &Encoded) -> Vec<f64> {
        let mut bytes = column
            .digits
            .bytes()
            .map(|byte| DIGITS.iter().position(|digit| *digit == byte).expect("a digit") as u64);
        let mut tokens = std::iter::from_fn(|| {
            let (mut token, mut shift) = (0, 0);
            loop {
                let digit = bytes.next()?;
                token |= (digit % MORE) << shift;
                shift += 5;
                if digit < MORE {
                    return Some(token);
                }
            }
        });
        let (mut last, mut slope, mut difference, mut values) = (0, 0, 0, Vec::new());
        while let Some(token) = tokens.next() {
            let times = match token {
                0 => {
                    values.push(f64::NAN);
                    0
                }
                1 => tokens.next().expect("a count"),
                token => {
                    let zigzag = (token - 2) as i64;
                    difference = (zigzag >> 1) ^ -(zigzag & 1);
                    1
                }
            };
            for _ in 0..times {
                slope = if column.order == 1 { difference } else { slope + difference };
                last += slope;
                values.push(column.offset + last as f64 * column.scale);
            }
        }
        values
    }

    fn largest_error(values: &[f64]) -> f64 {
        let back = decoded(&Encoded::of(values, STEPS[0]));
        assert_eq!(back.len(), values.len());
        let pairs = values.iter().zip(&back);
        assert!(
            pairs.clone().all(|(value, back)| value.is_finite() == back.is_finite()),
            "{values:?} {back:?}"
        );
        pairs
            .filter(|(value, _)| value.is_finite())
            .map(|(value, back)| (value - back).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn values_come_back_within_half_a_millionth_of_their_range() {
        let sine: Vec<_> = (0..5000).map(|step| 3.0 + (f64::from(step) * 1e-3).sin()).collect();
        let held: Vec<_> = sine.iter().step_by(10).flat_map(|value| [*value; 10]).collect();
        let noise: Vec<_> =
            (0_u32..5000).map(|step| f64::from(step.wrapping_mul(2_654_435_761) >> 8) - 1e7).collect();
        for values in [&sine, &held, &noise] {
            let span = values.iter().fold(f64::MIN, |a, b| a.max(*b))
                - values.iter().fold(f64::MAX, |a, b| a.min(*b));
            assert!(largest_error(values) <= span * 0.501 / STEPS[0]);
        }
        assert!(Encoded::of(&sine, STEPS[0]).digits.len() < 2 * sine.len());
        assert!(Encoded::of(&held, STEPS[0]).digits.len() < held.len());
    }

    #[test]
    fn gaps_and_constants_come_back() {
        let nan = f64::NAN;
        for values in [
            vec![],
            vec![2.5],
            vec![nan; 3],
            vec![1.0, 1.0, 1.0, nan, nan, 1.0, 1.0, 4.0, f64::INFINITY, 4.0],
        ] {
            assert!(largest_error(&values) < 1e-5, "{values:?}");
        }
        assert!(Encoded::of(&[0.25; 25_000], STEPS[0]).digits.len() < 10);
    }

    #[test]
    fn a_range_beyond_that_of_a_number_is_cut_off() {
        let back = decoded(&Encoded::of(&[-f64::MAX, 0.0, f64::NAN, f64::MAX], STEPS[0]));
        let near = |value: f64, wanted: f64| (value - wanted).abs() <= LARGEST * 1e-5;
        assert!(near(back[0], -LARGEST) && near(back[1], 0.0) && near(back[3], LARGEST), "{back:?}");
        assert!(back[2].is_nan());
    }

    #[test]
    fn regular_times_need_next_to_nothing_and_are_exact_to_a_microsecond() {
        let times: Vec<_> = (0..25_000).map(|step| f64::from(step) * 1e-3).collect();
        let column = Encoded::of_times(&times);
        assert!(column.digits.len() < 20, "{}", column.digits);
        let back = decoded(&column);
        assert!(times.iter().zip(&back).all(|(time, back)| (time - back).abs() < 1e-9));
    }
}
