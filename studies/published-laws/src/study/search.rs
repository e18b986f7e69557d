//! The search, equal for every law: the same number of evaluations, the same plants, the same cost, the same seed.
//!
//! Half of the evaluations are drawn uniformly from the ranges, in logarithms. The other half vary the best point so far,
//! within a width that shrinks. The first point is the middle of the ranges.

use std::vec::Vec;

use anyhow::Result;
use battery::campaign::Battery;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::case;
use super::cost::{self, Cost};
use super::laws::Law;

/// Evaluations of the cost for each law.
pub const EVALUATIONS: u32 = 300;
const SEED: u64 = 1;
/// Width of a variation as a fraction of a range, at the start and at the end.
const WIDTHS: [f64; 2] = [0.3, 0.02];
/// Fraction of the parameters that a variation changes.
const VARIED: f64 = 0.5;

/// A point of the search: one value for each tuned parameter of the law, and its cost.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    pub values: Vec<f64>,
    pub cost_s: f64,
}

/// The best point for a battery; `report` receives each improvement with the number of its evaluation.
///
/// # Errors
/// A run can't be carried out with the first point. Any later point that the law rejects isn't a candidate.
pub fn best(law: &Law, battery: Battery, report: impl FnMut(u32, &Point)) -> Result<Point> {
    let searched = law.searched(battery);
    let evaluate = |place: &[f64], bound_s: f64| {
        let values: Vec<_> =
            searched.iter().zip(place).map(|(tuned, &at)| value_at(tuned.range, at)).collect();
        Ok(Point { cost_s: cost_s(law, battery, Some(&values), bound_s)?, values })
    };
    minimise(searched.len(), evaluate, report)
}

/// The cost of a law with these values. What already costs more than the bound after some plants needs no further plant.
///
/// # Errors
/// A run can't be carried out.
pub fn cost_s(law: &Law, battery: Battery, values: Option<&[f64]>, bound_s: f64) -> Result<f64> {
    let plants = cost::plants(battery);
    let mut cost = Cost::default();
    for plant in &plants {
        cost = cost.with(&case::figures(law, *plant, values, cost::DURATION_S)?);
        if cost.of_s(plants.len()) >= bound_s {
            break;
        }
    }
    Ok(cost.of_s(plants.len()))
}

/// Minimises over the unit cube. A point that costs more than the bound may return any cost above it.
fn minimise(
    dimensions: usize,
    mut evaluate: impl FnMut(&[f64], f64) -> Result<Point>,
    mut report: impl FnMut(u32, &Point),
) -> Result<Point> {
    let mut random = Pcg64::seed_from_u64(SEED);
    let mut uniform = move || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let mut place = std::vec![0.5; dimensions];
    let mut best = evaluate(&place, f64::INFINITY)?;
    report(1, &best);
    for evaluation in 2..=EVALUATIONS {
        let half = EVALUATIONS / 2;
        let candidate: Vec<f64> = if evaluation <= half {
            (0..dimensions).map(|_| uniform()).collect()
        } else {
            let [begin, end] = WIDTHS;
            let done = f64::from(evaluation - half) / f64::from(EVALUATIONS - half);
            let width = begin * (end / begin).powf(done);
            let mut varied = |at: f64| {
                let (moved, draw) = (uniform() < VARIED, uniform());
                if moved { (at + width * (2.0 * draw - 1.0)).clamp(0.0, 1.0) } else { at }
            };
            place.iter().map(|&at| varied(at)).collect()
        };
        let Ok(point) = evaluate(&candidate, best.cost_s) else { continue };
        if point.cost_s < best.cost_s {
            (best, place) = (point, candidate);
            report(evaluation, &best);
        }
    }
    Ok(best)
}

/// The value at a place from 0 to 1 of a range, with four digits: more would not be repeatable by hand.
fn value_at([low, high]: [f64; 2], place: f64) -> f64 {
    let value = low * (high / low).powf(place);
    std::format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn search_finds_a_minimum_and_repeats_it() {
        let evaluate = |place: &[f64], _: f64| {
            let cost_s = place.iter().map(|at| (at - 0.3) * (at - 0.3)).sum();
            Ok(Point { values: place.to_vec(), cost_s })
        };
        let mut evaluations = Vec::new();
        let mut search =
            || minimise(6, evaluate, |evaluation, _| evaluations.push(evaluation)).expect("a point");
        let point = search();
        assert_eq!(point, search());
        assert!(point.cost_s < 0.01, "{point:?}");
        assert!(evaluations.iter().all(|&evaluation| evaluation <= EVALUATIONS));
    }

    #[test]
    fn range_is_searched_in_logarithms() {
        assert_eq!([0.0, 0.5, 1.0].map(|place| value_at([0.01, 100.0], place)), [0.01, 1.0, 100.0]);
    }
}
