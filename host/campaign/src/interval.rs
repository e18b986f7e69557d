//! Two-sided confidence intervals that assume no distribution.
//!
//! For a quantile: ranks of order statistics (David and Nagaraja, "Order Statistics", 3rd edition, section 7.1). For a fraction:
//! Clopper and Pearson, Biometrika 26 (1934). Both are exact in the binomial distribution, hence conservative.

/// Ranks, from 1, between which the q-quantile of the population lies; `None` where the runs are too few for a bound.
#[must_use]
pub fn quantile_ranks(quantile: f64, runs: u64, confidence: f64) -> [Option<u64>; 2] {
    let tail = (1.0 - confidence) / 2.0;
    let Some(binomial) = Binomial::new(runs, quantile) else { return [None, None] };
    // The r-th smallest lies above the quantile if at most r - 1 runs lie below it.
    let lower = binomial.largest_with_lower_tail(tail).map(|below| below + 1);
    let upper = binomial.smallest_with_lower_tail(1.0 - tail).map(|below| below + 1);
    [lower, upper.filter(|rank| *rank <= runs)]
}

/// Bounds of the probability behind `successes` of `runs`.
#[must_use]
pub fn fraction(successes: u64, runs: u64, confidence: f64) -> [f64; 2] {
    let tail = (1.0 - confidence) / 2.0;
    let at_most =
        |count: u64, p: f64| Binomial::new(runs, p).map_or(1.0, |binomial| binomial.lower_tail(count));
    let lower = match successes {
        0 => 0.0,
        // P(at least the observed number) = tail.
        _ => bisect(|p| 1.0 - at_most(successes - 1, p) < tail),
    };
    let upper = if successes >= runs { 1.0 } else { bisect(|p| at_most(successes, p) > tail) };
    [lower, upper]
}

/// The end of the range of p, from 0, in which `is_below` holds.
fn bisect(is_below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if is_below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Binomial probabilities around the mode. Far tails, below 1e-20 of the mode, are left out.
struct Binomial {
    first: u64,
    /// Cumulative, from `first`.
    cumulative: Vec<f64>,
}

impl Binomial {
    /// `None` for p of 0 or 1 and without a run.
    fn new(runs: u64, p: f64) -> Option<Self> {
        const NEGLIGIBLE: f64 = 1e-20;
        if runs == 0 || p <= 0.0 || p >= 1.0 {
            return None;
        }
        let (n, odds) = (runs as f64, p / (1.0 - p));
        let mode = (((n + 1.0) * p) as u64).min(runs);
        let (mut below, mut above) = (Vec::new(), vec![1.0]);
        let (mut weight, mut at) = (1.0, mode);
        while at > 0 && weight > NEGLIGIBLE {
            weight *= at as f64 / ((n - at as f64 + 1.0) * odds);
            below.push(weight);
            at -= 1;
        }
        let first = at;
        (weight, at) = (1.0, mode);
        while at < runs && weight > NEGLIGIBLE {
            weight *= (n - at as f64) * odds / (at as f64 + 1.0);
            above.push(weight);
            at += 1;
        }
        let total: f64 = below.iter().rev().chain(&above).sum();
        let mut sum = 0.0;
        let cumulative = below.iter().rev().chain(&above).map(|weight| {
            sum += weight;
            sum / total
        });
        Some(Self { first, cumulative: cumulative.collect() })
    }

    /// P(at most `count`).
    fn lower_tail(&self, count: u64) -> f64 {
        match count.checked_sub(self.first) {
            None => 0.0,
            Some(index) => self.cumulative.get(index as usize).copied().unwrap_or(1.0),
        }
    }

    /// The largest count with P(at most the count) <= `probability`.
    fn largest_with_lower_tail(&self, probability: f64) -> Option<u64> {
        (self.first + self.cumulative.partition_point(|tail| *tail <= probability) as u64).checked_sub(1)
    }

    /// The smallest count with P(at most the count) >= `probability`.
    fn smallest_with_lower_tail(&self, probability: f64) -> Option<u64> {
        let index = self.cumulative.partition_point(|tail| *tail < probability);
        (index < self.cumulative.len()).then_some(self.first + index as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::rand_core::SeedableRng as _;

    #[test]
    fn clopper_pearson_matches_published_values() {
        // R: binom.test(8, 10), binom.test(0, 10), binom.test(95, 100).
        for (successes, runs, [low, high]) in [
            (8, 10, [0.443_904_5, 0.974_789_3]),
            (0, 10, [0.0, 0.308_497_1]),
            (10, 10, [0.691_502_9, 1.0]),
            (95, 100, [0.887_165_1, 0.983_568_1]),
        ] {
            let have = fraction(successes, runs, 0.95);
            assert!(
                (have[0] - low).abs() < 1e-6 && (have[1] - high).abs() < 1e-6,
                "{successes}/{runs}: {have:?}"
            );
        }
    }

    #[test]
    fn median_of_ten_lies_between_the_second_and_the_ninth() {
        // P(Bin(10, 0.5) <= 1) = 0.0107, P(<= 2) = 0.0547.
        assert_eq!(quantile_ranks(0.5, 10, 0.95), [Some(2), Some(9)]);
        assert_eq!(quantile_ranks(0.95, 20, 0.95)[1], None, "20 runs bound no 95 % quantile from above");
        assert!(
            quantile_ranks(0.95, 1_000_000, 0.95)[1].is_some_and(|rank| (950_400..950_460).contains(&rank))
        );
    }

    /// A level of 90 % is kept by 90 % of experiments or a little more.
    #[test]
    fn intervals_cover_the_truth_as_often_as_they_claim() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(5);
        let (mut quantiles, mut fractions) = (0, 0);
        let [lower, upper] = quantile_ranks(0.8, 100, 0.9);
        for _ in 0..2000 {
            let mut drawn: Vec<_> = (0..100).map(|_| lashloop_plant::random::uniform(&mut random)).collect();
            drawn.sort_unstable_by(f64::total_cmp);
            let at = |rank: Option<u64>| drawn[rank.expect("a rank") as usize - 1];
            quantiles += u32::from(at(lower) <= 0.8 && 0.8 <= at(upper));
            let successes = drawn.iter().filter(|number| **number < 0.8).count();
            let [low, high] = fraction(successes as u64, 100, 0.9);
            fractions += u32::from((low..=high).contains(&0.8));
        }
        for covered in [quantiles, fractions] {
            assert!((1780..=1960).contains(&covered), "{covered} of 2000");
        }
    }
}
