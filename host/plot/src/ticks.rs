//! Ticks at multiples of 1, 2 or 5 times a power of ten, or at the powers of ten of a logarithmic axis.

use super::span::Span;

/// Fraction of a step by which data may exceed the outermost tick, at most a tenth of a pixel. Without it, the axis of a
/// run of 25.001 s would extend to 30 s.
const OVERHANG: f64 = 1e-3;

/// Ticks of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ticks {
    /// Evenly spaced.
    Even(Even),
    /// Of an axis whose coordinate is the decimal logarithm: a label at each power of ten, a line at each multiple of one.
    Decades(Span),
}

/// Evenly spaced ticks: the multiples `first..=last` of `mantissa * 10^exponent`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Even {
    mantissa: i64,
    exponent: i32,
    first: i64,
    last: i64,
}

impl Ticks {
    /// The finest even ticks around `span` that need no more than `intervals` intervals.
    pub fn covering(span: Span, intervals: i64) -> Self {
        Self::Even(Even::covering(span, intervals))
    }

    /// The range from the first tick to the last; of a logarithmic axis that of its values.
    pub fn span(&self) -> Span {
        match self {
            Self::Even(even) => even.span(),
            Self::Decades(span) => *span,
        }
    }

    /// Position and label of each tick, from low to high. Labels are in units of `10^factor()`; a tick without one has a line.
    pub fn labelled(&self) -> Vec<(f64, String)> {
        match self {
            Self::Even(even) => even.labelled().collect(),
            Self::Decades(span) => decades(*span),
        }
    }

    /// Power of ten to factor out of the labels; zero while plain decimals are short.
    pub fn factor(&self) -> i32 {
        match self {
            Self::Even(even) => even.factor(),
            Self::Decades(_) => 0,
        }
    }
}

/// Lines at the multiples of the powers of ten within a range of logarithms, with labels at the powers. A range of less than two
/// decades has labels at 2 and 5 too.
fn decades(span: Span) -> Vec<(f64, String)> {
    let within = span.low - 1e-9..=span.high + 1e-9;
    let exponents = span.low.floor() as i32..=span.high.ceil() as i32;
    let is_short = span.high - span.low < 2.0;
    let multiples = exponents.flat_map(|exponent| (1..10).map(move |multiple| (exponent, multiple)));
    let ticks = multiples.map(|(exponent, multiple)| {
        let is_labelled = multiple == 1 || (is_short && [2, 5].contains(&multiple));
        let decimals = usize::try_from(-exponent).unwrap_or(0);
        let value = scaled(multiple, exponent);
        (value.log10(), if is_labelled { format!("{value:.decimals$}") } else { String::new() })
    });
    ticks.filter(|(at, _)| within.contains(at)).collect()
}

impl Even {
    fn covering(span: Span, intervals: i64) -> Self {
        let rough = (span.high - span.low) / intervals.max(1) as f64;
        // One decade below the rough step is always too fine, so the search ends at the finest step that is not.
        let mut exponent = rough.log10().floor() as i32 - 1;
        loop {
            for mantissa in [1, 2, 5] {
                let step = scaled(mantissa, exponent);
                let first = (span.low / step + OVERHANG).floor() as i64;
                let last = (span.high / step - OVERHANG).ceil() as i64;
                if last - first <= intervals.max(1) {
                    return Self { mantissa, exponent, first, last: last.max(first + 1) };
                }
            }
            exponent += 1;
        }
    }

    fn span(&self) -> Span {
        Span { low: self.value(self.first), high: self.value(self.last) }
    }

    fn labelled(&self) -> impl Iterator<Item = (f64, String)> {
        let shown_exponent = self.exponent - self.factor();
        let decimals = usize::try_from(-shown_exponent).unwrap_or(0);
        (self.first..=self.last).map(move |multiple| {
            let shown = scaled(multiple * self.mantissa, shown_exponent);
            (self.value(multiple), format!("{shown:.decimals$}").replace('-', "\u{2212}"))
        })
    }

    fn factor(&self) -> i32 {
        let span = self.span();
        let largest = span.low.abs().max(span.high.abs());
        if largest >= 1e5 || self.exponent < -4 { largest.log10().floor() as i32 } else { 0 }
    }

    fn value(&self, multiple: i64) -> f64 {
        scaled(multiple * self.mantissa, self.exponent)
    }
}

/// `integer * 10^exponent`, dividing for a negative exponent: 3 / 10 is the double nearest to 0.3, 3 * 0.1 is not.
fn scaled(integer: i64, exponent: i32) -> f64 {
    let power = 10f64.powi(exponent.abs());
    if exponent < 0 { integer as f64 / power } else { integer as f64 * power }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(low: f64, high: f64) -> Vec<f64> {
        Ticks::covering(Span { low, high }, 7).labelled().into_iter().map(|(value, _)| value).collect()
    }

    fn labels(low: f64, high: f64) -> Vec<String> {
        Ticks::covering(Span { low, high }, 7).labelled().into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn steps_are_one_two_or_five_times_a_power_of_ten_and_cover_the_data() {
        let mut spread = 1e-12;
        while spread < 1e12 {
            for low in [0.0, -0.3 * spread, -spread, 17.3 * spread, -40.0 * spread] {
                let high = low + spread;
                let ticks = ticks(low, high);
                let step = ticks[1] - ticks[0];
                let mantissa = step / 10f64.powf(step.log10().floor());
                let is_nice = [1.0, 2.0, 5.0, 10.0].iter().any(|nice| (mantissa - nice).abs() < 1e-6);
                assert!(is_nice, "step {step:e} for {low:e}..{high:e}");
                assert!(ticks.len() <= 8, "{} ticks for {low:e}..{high:e}", ticks.len());
                assert!(ticks[0] <= low + 1.001e-3 * step, "first {} for {low:e}..{high:e}", ticks[0]);
                let last = ticks[ticks.len() - 1];
                assert!(last >= high - 1.001e-3 * step, "last {last} for {low:e}..{high:e}");
            }
            spread *= 1.37;
        }
    }

    #[test]
    fn ranges_at_the_ends_of_what_is_drawable_get_ticks_too() {
        for values in [[1e-290, 1.000_000_01e-290], [0.0, 1e-300], [-9.9e299, 9.9e299]] {
            let span = Span::of(values.into_iter()).expect("drawable values");
            let ticks = ticks(span.low, span.high);
            assert!((2..=8).contains(&ticks.len()), "{ticks:?}");
            assert!(ticks.windows(2).all(|pair| pair[0] < pair[1]), "{ticks:?}");
        }
    }

    #[test]
    fn one_sample_past_the_last_tick_adds_no_interval() {
        assert_eq!(ticks(0.0, 25.001), [0.0, 5.0, 10.0, 15.0, 20.0, 25.0]);
    }

    #[test]
    fn labels_have_just_the_decimals_of_the_step_and_a_true_minus() {
        assert_eq!(labels(-0.16, 1.57), ["\u{2212}0.5", "0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(labels(0.0, 0.3), ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"]);
    }

    #[test]
    fn very_large_and_very_small_values_share_one_power_of_ten() {
        let large = Ticks::covering(Span { low: 0.0, high: 3e7 }, 7);
        assert_eq!(large.factor(), 7);
        assert_eq!(large.labelled().pop().map(|(_, label)| label).as_deref(), Some("3.0"));
        let small = Ticks::covering(Span { low: 0.0, high: 4e-6 }, 4);
        assert_eq!(small.factor(), -6);
        assert_eq!(small.labelled().pop().map(|(_, label)| label).as_deref(), Some("4"));
    }

    #[test]
    fn decades_have_a_label_at_each_power_of_ten_and_a_line_at_each_multiple() {
        let ticks = Ticks::Decades(Span { low: -1.0, high: 200.0_f64.log10() }).labelled();
        let labels: Vec<_> = ticks.iter().filter(|(_, label)| !label.is_empty()).cloned().collect();
        let want =
            [(-1.0, "0.1"), (0.0, "1"), (1.0, "10"), (2.0, "100")].map(|(at, label)| (at, label.to_owned()));
        assert_eq!(labels, want);
        assert_eq!(ticks.len(), 9 + 9 + 9 + 2);
        let short = Ticks::Decades(Span { low: 0.2, high: 1.3 }).labelled();
        let labels: Vec<_> = short.into_iter().map(|(_, label)| label).filter(|it| !it.is_empty()).collect();
        assert_eq!(labels, ["2", "5", "10"]);
    }
}
