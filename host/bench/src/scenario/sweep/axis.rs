//! `[[sweep.axis]]`: a key of the scenario and the values that it takes.

use std::fmt;
use std::sync::Arc;

use crate::number::six_digits;
use crate::scenario::declare::{choice, integer, number, text, values};
use crate::scenario::origin::Origin;
use crate::scenario::reader::Section;
use crate::scenario::spelling::spell_number;
use crate::scenario::tree::{Node, Value};
use crate::settings;

/// Values of one axis at most.
pub(super) const MAX_VALUES: u32 = 10_000;

/// A key that varies.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) key: String,
    pub(super) origin: Origin,
    pub(super) values: Values,
}

/// The values of an axis.
#[derive(Debug, Clone)]
pub(super) enum Values {
    Listed(Vec<Value>),
    Range(Range),
}

/// A range that is sampled; `points` of a grid and of a list, `None` in a Latin hypercube.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    min: f64,
    max: f64,
    scale: Scale,
    pub(super) points: Option<u32>,
}

settings! {
    /// Spacing of points in a range.
    pub(super) enum Scale {
        /// equal differences
        "linear" => Linear,
        /// equal ratios
        "logarithmic" => Logarithmic,
        /// equal differences, rounded to whole numbers
        "whole" => Whole,
    }
}

/// A value of a key in one case. Displayed as `key=value`, as after `--set`.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Path of the key.
    pub key: String,
    pub(in crate::scenario) node: Node,
}

impl Setting {
    pub(super) fn new(key: &str, value: Value, axis: &Origin) -> Self {
        let setting: Arc<str> = format!("{key}={}", spell(&value)).into();
        let origin = match axis.place() {
            Some((file, line, column)) => Origin::Sweep { file: file.clone(), line, column, setting },
            None => axis.clone(),
        };
        Self { key: key.to_owned(), node: Node { origin, value } }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, spell(&self.node.value))
    }
}

fn spell(value: &Value) -> String {
    match value {
        Value::Text(text) => text.clone(),
        Value::Float(number) => spell_number(*number),
        other => other.to_string(),
    }
}

impl Range {
    /// The value at a fraction, 0 to 1, of the range. Six significant digits identify a case and repeat it.
    pub(super) fn at(&self, fraction: f64) -> Value {
        let Self { min, max, scale, .. } = *self;
        let exact = match scale {
            Scale::Linear | Scale::Whole => min + fraction * (max - min),
            Scale::Logarithmic => min * (max / min).powf(fraction),
        };
        match scale {
            Scale::Whole => Value::Integer(exact.round() as i64),
            Scale::Linear | Scale::Logarithmic => {
                Value::Float(six_digits(exact).clamp(min.min(max), max.max(min)))
            }
        }
    }
}

settings! {
    /// `[[sweep.axis]]` as it is written.
    pub(super) struct AxisKeys {
        /// Path of the key, such as `plant.dead_zone_rad`.
        key: String = text("the path of a key, such as \"plant.dead_zone_rad\""),
        /// Values of the key, instead of a range.
        values: Option<Vec<Node>> = values(),
        /// Lower end of the range.
        min: Option<f64> = number(-1e12..=1e12).optional(),
        /// Upper end of the range.
        max: Option<f64> = number(-1e12..=1e12).optional(),
        /// Number of points of the range, both ends included. A Latin hypercube has `sweep.points`.
        points: Option<u32> = integer(2..=MAX_VALUES).optional(),
        /// Spacing of points in the range.
        scale: Scale = choice().or(Scale::Linear),
    }
}

impl Axis {
    /// Checks an axis. If the sweep `is_sampled`, every axis is a range, and the sweep has the number of points.
    pub(super) fn checked(keys: AxisKeys, axis: &mut Section<'_>, is_sampled: bool) -> Self {
        let AxisKeys { key, values, min, max, points, scale } = keys;
        if key.split('.').next() == Some("sweep") {
            axis.reject("key", "is a key of the sweep itself; name a key of the run");
        }
        let values = match (values, min, max) {
            (Some(values), None, None) => {
                if is_sampled {
                    axis.reject("values", "is a list, and a Latin hypercube samples min to max");
                }
                for key in ["points", "scale"] {
                    axis.reject(key, "belongs to a range, and this axis has values");
                }
                Values::Listed(values.into_iter().map(|node| node.value).collect())
            }
            (None, Some(min), Some(max)) => {
                if min >= max {
                    axis.reject("max", format!("isn't an upper end; it must be > {}", spell_number(min)));
                }
                if scale == Scale::Logarithmic && min <= 0.0 {
                    axis.reject("min", "has no logarithm; it must be > 0");
                }
                match (is_sampled, points) {
                    (false, None) => axis.reject_section("has a range without points; add points"),
                    (true, Some(_)) => {
                        axis.reject("points", "is given twice: sweep.points is for every axis");
                    }
                    _ => {}
                }
                Values::Range(Range { min, max, scale, points })
            }
            _ => {
                // A faulty list has its own error.
                if !axis.has("values") || min.is_some() || max.is_some() {
                    axis.reject_section("must give either values, or both min and max");
                }
                Values::Listed(Vec::new())
            }
        };
        Self { key, origin: axis.origin_of("key"), values }
    }
}
