//! An axis of a grid: its ticks, and the place of a value between them.

use crate::axis::{Axis, AxisValue};

/// An axis of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct GridAxis {
    /// Its label, else its first key.
    pub label: String,
    pub unit: String,
    /// The key whose value multiplies those of the axis.
    pub times: Option<String>,
    /// First and last value of each tick; equal unless neighbouring values have one cell.
    pub ticks: Vec<[AxisValue; 2]>,
    pub(crate) values: u64,
    pub(crate) values_per_tick: u64,
}

impl GridAxis {
    pub(crate) fn new(axis: &Axis, most_ticks: u64) -> Self {
        let values = axis.values.len();
        let values_per_tick = values.div_ceil(most_ticks.max(1)).max(1);
        let starts = (0..values).step_by(values_per_tick as usize);
        let ticks = starts.map(|first| {
            let last = (first + values_per_tick).min(values) - 1;
            [first, last].map(|index| axis.values.at_index(index))
        });
        Self {
            label: axis.label.clone().unwrap_or_else(|| axis.name().to_owned()),
            unit: axis.unit.clone(),
            times: axis.times.clone(),
            ticks: ticks.collect(),
            values,
            values_per_tick,
        }
    }

    /// The number in the middle of a tick.
    fn number(&self, tick: usize) -> Option<f64> {
        let [first, last] = &self.ticks[tick];
        Some((first.number()? + last.number()?) / 2.0)
    }

    /// The tick at or before a value, and how far the value is on the way to the next tick, 0 to 1.
    pub(crate) fn position(&self, value: f64) -> Result<(usize, f64), PlaceError> {
        let numbers: Option<Vec<_>> = (0..self.ticks.len()).map(|tick| self.number(tick)).collect();
        let numbers = numbers.ok_or_else(|| PlaceError::NoNumber { axis: self.label.clone() })?;
        if let Some(tick) = numbers.iter().position(|number| *number == value) {
            return Ok((tick, 0.0));
        }
        let between = numbers
            .windows(2)
            .position(|pair| (pair[0] < value && value < pair[1]) || (pair[1] < value && value < pair[0]));
        match between {
            Some(tick) => Ok((tick, (value - numbers[tick]) / (numbers[tick + 1] - numbers[tick]))),
            None => Err(PlaceError::Beyond {
                axis: self.label.clone(),
                unit: self.unit.clone(),
                value,
                min: numbers.iter().copied().fold(f64::INFINITY, f64::min),
                max: numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            }),
        }
    }
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlaceError {
    #[error("a point of {given} values on a map of {axes} axes; give one value for each axis")]
    Dimensions { given: usize, axes: usize },
    #[error("axis {axis} has values that aren't numbers, so it has no place between them")]
    NoNumber { axis: String },
    #[error(
        "{axis} of {value} {unit} is outside the map, {min} to {max} {unit}; extend the axis of the campaign"
    )]
    Beyond { axis: String, unit: String, value: f64, min: f64, max: f64 },
}
