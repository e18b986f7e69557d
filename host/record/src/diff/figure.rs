//! Values with the digits that they deserve.

pub use lashloop_bench::number::figure;

/// Two values with six significant digits if these distinguish them, else with all.
#[must_use]
pub fn exact([a, b]: [f64; 2]) -> [String; 2] {
    let short = [a, b].map(figure);
    if short[0] != short[1] {
        return short;
    }
    // A torque is a single-precision number: its own shortest digits are fewer.
    let all = |value: f64| {
        let single = value as f32;
        if f64::from(single) == value { format!("{single:?}") } else { format!("{value:?}") }
    };
    [a, b].map(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_six_digits_and_no_more() {
        let figures = [0.001_436_893_756_557, -0.0, 12_345_678.9, 1e-9, 25.0, f64::NAN].map(figure);
        assert_eq!(figures, ["0.00143689", "0", "1.23457e7", "1e-9", "25", "NaN"]);
    }

    #[test]
    fn values_that_differ_in_the_last_bit_are_written_in_full() {
        let [a, b] = [1.5_f32, f32::from_bits(1.5_f32.to_bits() + 1)].map(f64::from);
        assert_eq!(exact([a, b]), ["1.5", "1.5000001"]);
        assert_eq!(exact([1.5, 2.5]), ["1.5", "2.5"]);
        assert_eq!(exact([0.0, -0.0]), ["0.0", "-0.0"]);
        assert_eq!(exact([0.1, f64::from_bits(0.1_f64.to_bits() + 1)]), ["0.1", "0.10000000000000002"]);
    }
}
