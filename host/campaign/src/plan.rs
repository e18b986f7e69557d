//! From the number of a case to its part, row, variant and values.
//!
//! Cases are in the order of parts; in a part in the order of rows; in a row in the order of variants.

pub use crate::axis::MAX_CASES;
use crate::axis::{Axis, AxisValue, Values, spread};
use crate::draw::{Stream, permuted};
use crate::settings::{Method, Part};
use crate::sobol::Dimension;

/// A case without its scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// From 0.
    pub number: u64,
    /// Index of the part.
    pub part: usize,
    /// Row in the part, from 0.
    pub row: u64,
    /// Index of the variant.
    pub variant: usize,
    /// The value of each axis of the part.
    pub values: Vec<AxisValue>,
}

#[derive(Debug, Clone)]
pub struct Plan {
    parts: Vec<PlannedPart>,
    variants: usize,
}

#[derive(Debug, Clone)]
struct PlannedPart {
    /// Rows of the parts before.
    start: u64,
    rows: u64,
    method: Method,
    axes: Vec<PlannedAxis>,
}

#[derive(Debug, Clone)]
struct PlannedAxis {
    values: Values,
    stream: Stream,
    /// Of a Latin hypercube.
    strata: u64,
    /// Of a Sobol sequence.
    dimension: Option<Dimension>,
    /// By variant.
    factors: Vec<Factor>,
}

/// What multiplies the value of an axis.
#[derive(Debug, Clone, Copy)]
enum Factor {
    Constant(f64),
    /// The value of an earlier axis of the part.
    Axis(usize),
}

impl Plan {
    /// Plans these parts. `base` gives the number that a key has in the scenario of a variant.
    ///
    /// # Errors
    /// What is wrong with a part.
    pub fn new(
        seed: u64,
        parts: &[Part],
        variants: usize,
        base: impl Fn(usize, &str) -> Option<f64>,
    ) -> Result<Self, String> {
        let mut planned = Vec::new();
        let mut start = 0_u64;
        for part in parts {
            let lengths = part.axes.iter().map(|axis| axis.values.len());
            let rows = match part.method {
                Method::Grid => lengths.fold(1, u64::saturating_mul),
                Method::List => lengths.max().unwrap_or(1),
                Method::Random | Method::LatinHypercube | Method::Sobol => part.points.unwrap_or(1),
            };
            let axes = part.axes.iter().enumerate();
            let axes = axes.map(|(at, axis)| {
                let factors = (0..variants).map(|variant| factor(part, at, |key| base(variant, key)));
                let stream = Stream::new(seed, axis.name());
                let dimension = Dimension::new(at, stream.key());
                let strata = Stream::new(seed, &format!("{} permutation", axis.name())).key();
                let factors = factors.collect::<Result<_, String>>()?;
                Ok(PlannedAxis { values: axis.values.clone(), stream, strata, dimension, factors })
            });
            let axes = axes.collect::<Result<_, String>>()?;
            planned.push(PlannedPart { start, rows, method: part.method, axes });
            start = start.saturating_add(rows);
        }
        let cases = start.saturating_mul(variants as u64);
        if cases > MAX_CASES {
            return Err(format!("has {cases} cases; at most {MAX_CASES} are allowed"));
        }
        Ok(Self { parts: planned, variants })
    }

    /// Number of cases.
    #[must_use]
    pub fn cases(&self) -> u64 {
        self.parts.last().map_or(0, |part| (part.start + part.rows) * self.variants as u64)
    }

    /// Rows of a part.
    #[must_use]
    pub fn rows(&self, part: usize) -> u64 {
        self.parts.get(part).map_or(0, |part| part.rows)
    }

    /// Part, row and variant of a case.
    #[must_use]
    pub fn place(&self, number: u64) -> (usize, u64, usize) {
        let (row, variant) = (number / self.variants as u64, (number % self.variants as u64) as usize);
        let part = self.parts.partition_point(|part| part.start <= row) - 1;
        (part, row - self.parts[part].start, variant)
    }

    /// Where a row of a sampled part lies on an axis, 0 to 1.
    #[must_use]
    pub fn fraction(&self, part: usize, axis: usize, row: u64) -> f64 {
        let part = &self.parts[part];
        part.fraction(&part.axes[axis], row)
    }

    /// A case of the campaign.
    #[must_use]
    pub fn case(&self, number: u64) -> Case {
        let (part, row, variant) = self.place(number);
        let planned = &self.parts[part];
        let values = planned.multiplied(planned.drawn(row), variant);
        Case { number, part, row, variant, values }
    }

    /// Cases of a part and variant that have each [checked value](Values::checked), one axis at a time with the first row's
    /// values of the others, and with both ends of the axis that multiplies it. Each has the axis that is varied.
    #[must_use]
    pub fn probes(&self, part: usize, variant: usize) -> Vec<(Option<usize>, Case)> {
        let planned = &self.parts[part];
        let case = |axis, row, drawn| {
            let number = (planned.start + row) * self.variants as u64 + variant as u64;
            let values = planned.multiplied(drawn, variant);
            (axis, Case { number, part, row, variant, values })
        };
        if planned.method == Method::List {
            // Its axes vary together; a list has each of its values.
            let is_listed = |axis: &PlannedAxis| matches!(axis.values, Values::Listed(_));
            let rows = match planned.axes.iter().any(is_listed) {
                true => (0..planned.rows).collect(),
                false => spread(planned.rows),
            };
            return rows.into_iter().map(|row| case(None, row, planned.drawn(row))).collect();
        }
        let mut probes = vec![case(None, 0, planned.drawn(0))];
        for (at, axis) in planned.axes.iter().enumerate() {
            for value in axis.values.checked() {
                let mut drawn = planned.drawn(0);
                drawn[at] = value;
                if let Factor::Axis(earlier) = axis.factors[variant] {
                    for factor in planned.axes[earlier].values.extremes() {
                        let mut drawn = drawn.clone();
                        drawn[earlier] = factor;
                        probes.push(case(Some(at), 0, drawn));
                    }
                }
                probes.push(case(Some(at), 0, drawn));
            }
        }
        probes
    }
}

impl PlannedPart {
    /// Of a sampled part.
    fn fraction(&self, axis: &PlannedAxis, row: u64) -> f64 {
        match self.method {
            Method::Grid | Method::List => 0.0,
            Method::Random => axis.stream.at(row),
            Method::LatinHypercube => {
                let stratum = permuted(axis.strata, row, self.rows) as f64;
                (stratum + axis.stream.at(row)) / self.rows as f64
            }
            Method::Sobol => axis.dimension.as_ref().map_or(0.0, |dimension| dimension.at(row)),
        }
    }

    /// The values of a row, without their factors.
    fn drawn(&self, row: u64) -> Vec<AxisValue> {
        // The last axis of a grid varies fastest.
        let mut combinations = self.rows;
        let drawn = self.axes.iter().map(|axis| {
            combinations /= axis.values.len().max(1);
            match self.method {
                Method::Grid => axis.values.at_index(row / combinations.max(1) % axis.values.len().max(1)),
                Method::List => axis.values.at_index(row),
                Method::Random | Method::LatinHypercube | Method::Sobol => {
                    axis.values.at_fraction(self.fraction(axis, row))
                }
            }
        });
        drawn.collect()
    }

    fn multiplied(&self, drawn: Vec<AxisValue>, variant: usize) -> Vec<AxisValue> {
        let mut values: Vec<AxisValue> = Vec::with_capacity(self.axes.len());
        for (axis, drawn) in self.axes.iter().zip(drawn) {
            let factor = match axis.factors[variant] {
                Factor::Constant(factor) => factor,
                Factor::Axis(earlier) => values[earlier].number().unwrap_or(f64::NAN),
            };
            values.push(match drawn {
                AxisValue::Number(number) => AxisValue::Number(factor * number),
                other => other,
            });
        }
        values
    }
}

fn factor(part: &Part, at: usize, base: impl Fn(&str) -> Option<f64>) -> Result<Factor, String> {
    let Axis { times, .. } = &part.axes[at];
    let Some(key) = times else { return Ok(Factor::Constant(1.0)) };
    if let Some(earlier) = part.axes[..at].iter().position(|axis| axis.keys.contains(key)) {
        if part.axes[earlier].values.extremes().iter().any(|value| value.number().is_none()) {
            return Err(format!(
                "has part {} with times = \"{key}\", whose axis has other values than numbers",
                part.name
            ));
        }
        return Ok(Factor::Axis(earlier));
    }
    let constant = base(key).map(Factor::Constant);
    constant.ok_or_else(|| {
        format!("has part {} with times = \"{key}\", and the scenario has no number of this key", part.name)
    })
}
