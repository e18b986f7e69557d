//! The count of the truths within their intervals, over many plants.

use std::collections::BTreeMap;
use std::fmt;

/// The interval of a quantity, with its truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// The true value.
    pub truth: f64,
}

/// Of one quantity, over all plants.
#[derive(Debug, Clone, Default)]
struct Tally {
    observed: usize,
    covered: usize,
    /// Half widths of the intervals relative to the truth.
    widths: Vec<f64>,
    /// Plants whose truth is outside, with its distance from the middle in half widths.
    outside: Vec<(u64, f64)>,
}

/// The truths within their intervals, for each quantity.
#[derive(Debug, Clone, Default)]
pub struct Coverage {
    plants: usize,
    followed: usize,
    refused: usize,
    tallies: BTreeMap<String, Tally>,
}

/// Whose truth may be 0 or near it: the half width is not divided by it.
const ABSOLUTE: [&str; 4] = [
    "load_friction_asymmetry",
    "cogging_phase_rad",
    "motor_eccentricity_phase_rad",
    "load_eccentricity_phase_rad",
];

impl Coverage {
    /// Takes a plant. `is_followed` is whether the model follows its motions to the quantisation.
    pub fn plant(&mut self, is_followed: bool) {
        self.plants += 1;
        self.followed += usize::from(is_followed);
    }

    /// Takes a plant whose commissioning has no estimates.
    pub fn refused(&mut self) {
        self.refused += 1;
    }

    /// Takes a quantity of that plant; `None` if the motions don't show it.
    pub fn quantity(&mut self, seed: u64, name: &str, shown: Option<Shown>) {
        let tally = self.tallies.entry(name.to_owned()).or_default();
        let Some(Shown { low, high, truth }) = shown else { return };
        tally.observed += 1;
        tally.covered += usize::from((low..=high).contains(&truth));
        let half = 0.5 * (high - low);
        tally.widths.push(if ABSOLUTE.contains(&name) || truth == 0.0 { half } else { half / truth });
        let away = (truth - 0.5 * (low + high)).abs() / half;
        if away > 1.0 {
            tally.outside.push((seed, away));
        }
    }

    /// Quantities outside their interval on more than one plant of ten; of fewer than ten plants one may miss.
    pub fn missed(&self) -> Vec<String> {
        self.lines(|it| it.observed - it.covered > (it.observed / 10).max(1))
    }

    /// Quantities that the motions show on fewer than half of the plants.
    pub fn unobserved(&self) -> Vec<String> {
        self.lines(|it| 2 * it.observed < self.plants)
    }

    /// Fraction of all intervals that contain the truth.
    pub fn fraction(&self) -> f64 {
        let sum = |of: fn(&Tally) -> usize| self.tallies.values().map(of).sum::<usize>() as f64;
        sum(|it| it.covered) / sum(|it| it.observed)
    }

    fn lines(&self, is_listed: impl Fn(&Tally) -> bool) -> Vec<String> {
        let line = |(name, it): (&String, &Tally)| {
            is_listed(it)
                .then(|| format!("{name}: {} of {}, {} plants", it.covered, it.observed, self.plants))
        };
        self.tallies.iter().filter_map(line).collect()
    }

    /// Whether the model follows nine of ten plants.
    pub fn follows(&self) -> bool {
        10 * self.followed >= 9 * self.plants
    }
}

impl fmt::Display for Coverage {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            out,
            "{} hidden plants, {} followed to the quantisation, {} refused: truth within the 95 % interval, median half width; truths \
             outside as plant:half widths",
            self.plants, self.followed, self.refused
        )?;
        for (name, Tally { observed, covered, widths, outside }) in &self.tallies {
            let mut widths = widths.clone();
            widths.sort_by(f64::total_cmp);
            let median = widths.get(widths.len() / 2).map_or(f64::NAN, |width| 100.0 * width);
            write!(out, "  {name:<26} {covered:>3} of {observed:<3} {median:>9.4} %")?;
            for (seed, away) in outside {
                write!(out, "  {seed}:{away:.2}")?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}
