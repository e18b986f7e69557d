//! The values of an axis: keys of the scenario that take one value together.

use std::collections::BTreeSet;
use std::fmt;

use lashloop_bench::scenario::declare::{any_text, choice, integer, number, scalars, texts};
use lashloop_bench::scenario::{Scalar, Section};
use lashloop_bench::settings;

/// Cases of a campaign, points of a part, and values of an axis, at most.
pub const MAX_CASES: u64 = 10_000_000;

/// A value of an axis. Displayed as in a table.
#[derive(Debug, Clone, PartialEq)]
pub enum AxisValue {
    Number(f64),
    Boolean(bool),
    Text(String),
}

impl AxisValue {
    /// The value as after `--set key=`.
    #[must_use]
    pub fn setting(&self) -> String {
        match self {
            // Quotes keep a text such as "1" from becoming a number.
            Self::Text(text) => toml_edit::Value::from(text.as_str()).to_string(),
            other => other.to_string(),
        }
    }

    #[must_use]
    pub const fn number(&self) -> Option<f64> {
        if let Self::Number(number) = self { Some(*number) } else { None }
    }
}

impl From<Scalar> for AxisValue {
    fn from(scalar: Scalar) -> Self {
        match scalar {
            Scalar::Number(number) => Self::Number(number),
            Scalar::Boolean(boolean) => Self::Boolean(boolean),
            Scalar::Text(text) => Self::Text(text),
        }
    }
}

impl fmt::Display for AxisValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // Counts and microseconds are whole numbers, which have no point in a scenario.
            Self::Number(number) if number.fract() == 0.0 && number.abs() < 1e15 => write!(out, "{number}"),
            Self::Number(number) => write!(out, "{number:?}"),
            Self::Boolean(boolean) => write!(out, "{boolean}"),
            Self::Text(text) => out.write_str(text),
        }
    }
}

/// An axis of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Keys of the scenario. The first one names the axis and its random stream.
    pub keys: Vec<String>,
    /// What the quantity is called in tables; the first key if absent.
    pub label: Option<String>,
    pub unit: String,
    pub values: Values,
    /// A key whose value multiplies the drawn one.
    pub times: Option<String>,
}

settings! {
    /// `[[part.axis]]` as it is written.
    pub(crate) struct AxisKeys {
        /// Path of the key, such as `plant.dead_zone_rad`.
        key: Option<String> = any_text(),
        /// Paths of several keys that take one value.
        keys: Option<Vec<String>> = texts("a list of texts in quotes").optional(),
        /// Name of the quantity in tables.
        label: Option<String> = any_text(),
        /// Unit in tables.
        unit: Option<String> = any_text(),
        /// Values, instead of a range.
        values: Option<Vec<Scalar>> = scalars(),
        /// Lower end of the range.
        min: Option<f64> = number(-1e12..=1e12).optional(),
        /// Upper end of the range.
        max: Option<f64> = number(-1e12..=1e12).optional(),
        /// Points of the range in a grid or a list, both ends included.
        points: Option<u64> = integer(2..=MAX_CASES).optional(),
        /// Spacing in the range.
        scale: Scale = choice().or(Scale::Linear),
        /// Key whose value in the scenario, or in an earlier axis of this part, multiplies each value.
        times: Option<String> = any_text(),
    }
}

impl Axis {
    pub(crate) fn checked(keys: AxisKeys, axis: &mut Section<'_>, is_sampled: bool) -> Self {
        let AxisKeys { key, keys, label, unit, values: listed, min, max, points, scale, times } = keys;
        let keys = match (key, keys) {
            (Some(key), None) => vec![key],
            (None, Some(keys)) if !keys.is_empty() => keys,
            _ => {
                axis.reject_section("must give either key, or keys");
                Vec::new()
            }
        };
        let values = match (listed, min, max) {
            (Some(listed), None, None) => Values::Listed(listed.into_iter().map(AxisValue::from).collect()),
            (None, Some(min), Some(max)) => {
                if min >= max {
                    axis.reject("max", format!("isn't an upper end; it must be > {min}"));
                }
                if scale == Scale::Whole && (min.fract() != 0.0 || max.fract() != 0.0) {
                    axis.reject("scale", format!("needs whole ends, and the range is {min} to {max}"));
                }
                if scale == Scale::Logarithmic && min <= 0.0 {
                    axis.reject("min", "has no logarithm; it must be > 0");
                }
                match points {
                    None if !is_sampled => axis.reject_section("has a range without points; add points"),
                    Some(_) if is_sampled => {
                        axis.reject("points", "is given twice: part.points is for every axis");
                    }
                    _ => {}
                }
                Values::Range(Range { min, max, scale, points })
            }
            _ => {
                axis.reject_section("must give either values, or both min and max");
                Values::Listed(vec![AxisValue::Number(0.0)])
            }
        };
        if let Values::Listed(listed) = &values
            && listed.iter().filter_map(AxisValue::number).any(|number| !number.is_finite())
        {
            axis.reject("values", "has a number that is not finite; remove it");
        }
        let is_text =
            matches!(&values, Values::Listed(listed) if listed.iter().any(|value| value.number().is_none()));
        if times.is_some() && is_text {
            axis.reject("times", "multiplies numbers, and this axis has other values");
        }
        Self { keys, label, unit: unit.unwrap_or_default(), values, times }
    }
}

impl Axis {
    /// Name of the axis and of its column.
    #[must_use]
    pub fn name(&self) -> &str {
        self.keys.first().map_or("", String::as_str)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    Listed(Vec<AxisValue>),
    Range(Range),
}

impl Values {
    /// Number of values in a grid or a list.
    #[must_use]
    pub fn len(&self) -> u64 {
        match self {
            Self::Listed(values) => values.len() as u64,
            Self::Range(range) => range.points.unwrap_or(1),
        }
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Value `index` of a grid or a list; a range includes both of its ends.
    #[must_use]
    pub fn at_index(&self, index: u64) -> AxisValue {
        match self {
            Self::Listed(values) => values[index as usize % values.len()].clone(),
            Self::Range(range) => {
                let last = range.points.unwrap_or(1).max(2) - 1;
                AxisValue::Number(range.at(index as f64 / last as f64))
            }
        }
    }

    /// Each value of a grid or a list, of long ranges evenly spread ones; else as [`extremes`](Self::extremes).
    #[must_use]
    pub fn checked(&self) -> Vec<AxisValue> {
        match self {
            Self::Range(Range { points: Some(points), .. }) => {
                spread(*points).into_iter().map(|index| self.at_index(index)).collect()
            }
            _ => self.extremes(),
        }
    }

    /// Whether no two values of a grid or a list are equal.
    #[must_use]
    pub fn are_distinct(&self) -> bool {
        match self {
            Self::Listed(values) => {
                let distinct: BTreeSet<_> = values.iter().map(AxisValue::setting).collect();
                distinct.len() == values.len()
            }
            Self::Range(Range { min, max, scale: Scale::Whole, points: Some(points) }) => {
                *points as f64 <= max - min + 1.0
            }
            Self::Range(_) => true,
        }
    }

    /// Each listed value, or both ends of the range.
    #[must_use]
    pub fn extremes(&self) -> Vec<AxisValue> {
        match self {
            Self::Listed(values) => values.clone(),
            Self::Range(Range { min, max, .. }) => [*min, *max].map(AxisValue::Number).to_vec(),
        }
    }

    /// The value at a fraction, 0 to 1. Each listed value has an equal part of it.
    #[must_use]
    pub fn at_fraction(&self, fraction: f64) -> AxisValue {
        match self {
            Self::Listed(values) => {
                let index = (fraction * values.len() as f64) as usize;
                values[index.min(values.len() - 1)].clone()
            }
            Self::Range(range) => AxisValue::Number(range.at(fraction)),
        }
    }
}

/// Places of a long axis that are checked before the first run.
const CHECKED: u64 = 1000;

/// Every place of `count`, or as many of them as are checked, the first and the last among them.
pub(crate) fn spread(count: u64) -> Vec<u64> {
    let checked = count.min(CHECKED);
    (0..checked).map(|at| at * (count - 1) / (checked - 1).max(1)).collect()
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    pub min: f64,
    pub max: f64,
    pub scale: Scale,
    /// Points of a grid or a list.
    pub points: Option<u64>,
}

settings! {
    /// Spacing in a range.
    pub enum Scale {
        /// equal differences
        "linear" => Linear,
        /// equal ratios
        "logarithmic" => Logarithmic,
        /// equal differences, rounded to whole numbers; of a sampled part each end has half the weight of the others
        "whole" => Whole,
    }
}

impl Range {
    /// The value at a fraction, 0 to 1. Equal on every machine: the power is that of libm in software.
    fn at(&self, fraction: f64) -> f64 {
        let Self { min, max, scale, .. } = *self;
        if fraction >= 1.0 {
            return max;
        }
        match scale {
            Scale::Linear => (min + (max - min) * fraction).clamp(min, max),
            Scale::Whole => (min + (max - min) * fraction).round(),
            Scale::Logarithmic => (min * libm::pow(max / min, fraction)).clamp(min, max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(min: f64, max: f64, scale: Scale) -> Values {
        Values::Range(Range { min, max, scale, points: Some(5) })
    }

    #[test]
    fn a_range_has_both_ends_and_equal_steps_or_ratios() {
        let all = |values: Values| {
            (0..5).map(|at| values.at_index(at).number().expect("a number")).collect::<Vec<_>>()
        };
        assert_eq!(all(range(1.0, 3.0, Scale::Linear)), [1.0, 1.5, 2.0, 2.5, 3.0]);
        assert_eq!(all(range(1.0, 8.0, Scale::Whole)), [1.0, 3.0, 5.0, 6.0, 8.0]);
        let ratios = all(range(1.0, 1e4, Scale::Logarithmic));
        for (have, want) in ratios.iter().zip([1.0, 10.0, 100.0, 1e3, 1e4]) {
            assert!((have / want - 1.0).abs() < 1e-12, "{ratios:?}");
        }
    }

    #[test]
    fn last_point_of_a_range_is_its_end() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            assert_eq!(range(1.73, 7.22, scale).at_index(4).number(), Some(7.22));
        }
    }

    #[test]
    fn settings_read_back_as_the_same_value() {
        for (value, want) in [
            (AxisValue::Number(1000.0), "1000"),
            (AxisValue::Number(0.1), "0.1"),
            (AxisValue::Number(1e300), "1e300"),
            (AxisValue::Boolean(true), "true"),
            (AxisValue::Text("1".to_owned()), "\"1\""),
        ] {
            assert_eq!(value.setting(), want);
        }
    }
}
