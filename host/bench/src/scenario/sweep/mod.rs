//! `[sweep]`: one scenario as many cases. Case number i is a function of the file alone.
//!
//! | module | is |
//! |---|---|
//! | `axis` | a key and its values; [`Setting`]: one of them |
//! | `latin_hypercube` | one point in every stratum of every axis |

mod axis;
mod latin_hypercube;

pub use axis::Setting;

use axis::{Axis, Values};

use super::declare::{Named, by, choice, integer, sections, skipped};
use super::origin::Origin;
use super::reader::Section;
use super::tree::Value;
use crate::settings;

/// Cases of a sweep at most: days of runs in real time, and a table that is still read.
const MAX_CASES: usize = 10_000;

const SEED: &str = "run.seed";

settings! {
    /// How the values of the axes are combined.
    pub(super) enum Method {
        /// every combination; the last axis varies fastest
        "grid" => Grid,
        /// the first values of all axes, then the second ones
        "list" => List,
        /// `points` random points; each of as many strata of an axis has one
        "latin-hypercube" => LatinHypercube,
    }
}

settings! {
    /// A sweep as the scenario has it.
    #[derive(Debug, Clone)]
    pub(super) struct Sweep {
        /// How the values of the axes are combined.
        method: Method = choice().or(Method::Grid),
        /// Points of a Latin hypercube, which needs them.
        points: Option<u32> = integer(1..=axis::MAX_VALUES).optional(),
        /// Seed of the points of a Latin hypercube.
        sampling_seed: u64 = integer(0..=i64::MAX.cast_unsigned()).or(1),
        /// Runs of each point, with `run.seed` 1, 2 and so on; absent for one run with the scenario's seed.
        seeds: Option<u32> = integer(1..=axis::MAX_VALUES).optional(),
        /// A key that varies.
        axes as "axis": Vec<Axis> = by(|sweep| {
            let is_sampled = is_sampled(sweep);
            sections(move |keys, axis| Axis::checked(keys, axis, is_sampled))
        }),
        /// Where the section begins.
        origin: Origin = skipped(|sweep| sweep.origin.clone()),
    }
}

/// Whether the method samples the ranges of the axes.
fn is_sampled(sweep: &Section<'_>) -> bool {
    sweep.text("method").and_then(Method::named) == Some(Method::LatinHypercube)
}

impl Sweep {
    pub(super) fn checked(self, sweep: &mut Section<'_>) -> Self {
        if !sweep.is_given() {
            return self;
        }
        match (is_sampled(sweep), self.points) {
            (true, None) => sweep.reject_section("is a Latin hypercube without points; add points"),
            (false, Some(_)) => sweep.reject("points", "belongs to method = \"latin-hypercube\""),
            _ => {}
        }
        if let Some(problem) = self.problem() {
            sweep.reject_section(problem);
        }
        self
    }

    /// Reports a sweep in a scenario of one run.
    pub(super) fn rejected(self, sweep: &mut Section<'_>) {
        let swept = self.checked(sweep);
        if sweep.is_given() {
            let reason =
                "cases of a sweep are run by `lashloop test`; for another command remove the section";
            sweep.reject_all(swept.count().to_string(), reason);
        }
    }

    /// What is wrong with the axes together, after "this section".
    fn problem(&self) -> Option<String> {
        if self.axes.is_empty() && self.seeds.is_none() {
            return Some("varies nothing; add [[sweep.axis]] or seeds".to_owned());
        }
        let swept = |key: &str| self.axes.iter().filter(|axis| axis.key == key).count();
        if let Some(axis) = self.axes.iter().find(|axis| swept(&axis.key) > 1) {
            return Some(format!("has two axes of {}; each key has one", axis.key));
        }
        if self.seeds.is_some() && swept(SEED) > 0 {
            return Some(format!("has both seeds and an axis of {SEED}; remove one"));
        }
        let lengths: Vec<_> = self.axes.iter().map(Axis::len).collect();
        if self.method == Method::List && lengths.windows(2).any(|pair| pair[0] != pair[1]) {
            let lengths: Vec<_> = lengths.iter().map(ToString::to_string).collect();
            return Some(format!(
                "is a list whose axes have {} values; all must have the same number",
                lengths.join(", ")
            ));
        }
        let count = self.count();
        (count > MAX_CASES).then(|| format!("has {count} cases; at most {MAX_CASES} are allowed"))
    }

    /// Number of cases, without bound.
    pub(super) fn count(&self) -> usize {
        let lengths = self.axes.iter().map(Axis::len);
        let points = match self.method {
            Method::Grid => lengths.fold(1, usize::saturating_mul),
            Method::List => lengths.max().unwrap_or(1),
            Method::LatinHypercube => self.points.unwrap_or(1) as usize,
        };
        points.saturating_mul(self.seeds.unwrap_or(1) as usize)
    }

    /// The settings of every case.
    pub(super) fn cases(&self) -> Vec<Vec<Setting>> {
        let points = self.points();
        let seeds = 1..=self.seeds.unwrap_or(1);
        let with_seed = |point: &Vec<Setting>, seed: u32| {
            let seed = self.seeds.map(|_| Setting::new(SEED, Value::Integer(seed.into()), &self.origin));
            point.iter().cloned().chain(seed).collect()
        };
        points.iter().flat_map(|point| seeds.clone().map(move |seed| with_seed(point, seed))).collect()
    }

    /// The settings of every point, without seeds.
    fn points(&self) -> Vec<Vec<Setting>> {
        match self.method {
            Method::Grid => self.axes.iter().fold(vec![Vec::new()], |points, axis| {
                let values = axis.settings();
                let with_each = |point: Vec<Setting>| {
                    let add = move |setting: Setting| [&*point, &[setting]].concat();
                    values.clone().into_iter().map(add).collect::<Vec<_>>()
                };
                points.into_iter().flat_map(with_each).collect()
            }),
            Method::List => {
                let columns: Vec<_> = self.axes.iter().map(Axis::settings).collect();
                let count = columns.iter().map(Vec::len).max().unwrap_or(1);
                let row = |index| columns.iter().filter_map(|column| column.get(index).cloned()).collect();
                (0..count).map(row).collect()
            }
            Method::LatinHypercube => {
                let fractions =
                    latin_hypercube::fractions(self.sampling_seed, self.axes.len(), self.points.unwrap_or(1));
                let point = |row: Vec<f64>| {
                    self.axes.iter().zip(row).filter_map(|(axis, fraction)| axis.at(fraction)).collect()
                };
                fractions.into_iter().map(point).collect()
            }
        }
    }
}

impl Axis {
    fn len(&self) -> usize {
        match &self.values {
            Values::Listed(values) => values.len(),
            Values::Range(range) => range.points.unwrap_or(1) as usize,
        }
    }

    /// The axis at a fraction, 0 to 1, of its range; `None` without one.
    fn at(&self, fraction: f64) -> Option<Setting> {
        match &self.values {
            Values::Listed(_) => None,
            Values::Range(range) => Some(Setting::new(&self.key, range.at(fraction), &self.origin)),
        }
    }

    fn settings(&self) -> Vec<Setting> {
        match &self.values {
            Values::Listed(values) => {
                values.iter().map(|value| Setting::new(&self.key, value.clone(), &self.origin)).collect()
            }
            Values::Range(range) => {
                let points = range.points.unwrap_or(1);
                let fraction = |index| f64::from(index) / f64::from(points.max(2) - 1);
                (0..points).filter_map(|index| self.at(fraction(index))).collect()
            }
        }
    }
}
