//! Whether the plant model of a scenario follows the recorded motion.
//!
//! The model is fed with the recorded torque. If its motion leaves the recorded one by more than encoders and intervals
//! explain, the run doesn't judge the law: it ran on another plant. The band of a sample is one count of the encoder, and
//! the root of the sum of squares of what each parameter moves within its interval.
//!
//! In bench mode nothing shows where in the gap the motor stands at the first sample. That twist is estimated from the
//! first second; what is left of it, delay and step of the torque move the model as parameters do.

mod model;
mod motion;

pub use motion::RecordedMotion;

use std::f64::consts::TAU;
use std::path::Path;
use std::{fmt, io};

use lashloop_bench::regular_file;
use lashloop_bench::run::RunError;
use lashloop_bench::scenario::Scenario;
use lashloop_identify::Instruments;
use lashloop_plant::PlantValue;
use serde::Deserialize;

use self::model::Model;
use super::power_stage::{TORQUE_DELAY_US, instruments};

/// Keys whose interval may reach to their least value.
const LEAST: [(&str, f64); 2] = [("cogging_nm", 0.0), ("cogging_per_turn", 1.0)];

/// What the plant may differ by from its model: the part of `estimates.json` that the gate reads.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(expecting = "the estimates of a plant")]
pub struct Intervals {
    quantities: Vec<Quantity>,
    /// Those of the commissioning; `None` for those of the scenario.
    instruments: Option<Instruments>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Quantity {
    name: String,
    estimate: Option<Interval>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Interval {
    value: f64,
    low: f64,
    high: f64,
}

/// Reads the intervals of `estimates.json`.
///
/// # Errors
/// The file can't be read or isn't a file of `identify` or `commission`.
pub fn intervals(path: &Path) -> io::Result<Intervals> {
    serde_json::from_slice(&regular_file::read(path)?).map_err(|error| {
        io::Error::other(format!(
            "it isn't an estimates.json of `lashloop commission` or `lashloop identify`: {error}"
        ))
    })
}

/// Where the recorded motion leaves the model the furthest, against its band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// `motor` or `load`.
    pub encoder: &'static str,
    pub time_s: f64,
    /// Distance of the recorded position from that of the model.
    pub distance_rad: f64,
    /// What encoder and intervals explain.
    pub limit_rad: f64,
}

impl fmt::Display for Departure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { encoder, time_s, distance_rad, limit_rad } = self;
        write!(
            out,
            "the plant model does not follow the recorded motion: at {time_s:.3} s the {encoder} is {distance_rad:.6} rad \
             from the model, encoder and intervals explain {limit_rad:.6} rad; identify the plant again with `lashloop \
             commission`, or give its intervals with --gate {}",
            super::files::ESTIMATES_FILE
        )
    }
}

/// Feeds the plant of a scenario with the recorded torque and compares the motions.
///
/// # Errors
/// The plant of the scenario can't be built, or not be followed under these torques.
pub fn check(
    scenario: &Scenario,
    recorded: &RecordedMotion,
    intervals: &Intervals,
) -> Result<Option<Departure>, RunError> {
    let encoders = &scenario.encoders;
    let count_rad =
        [encoders.motor_counts_per_rev, encoders.load_counts_per_rev].map(|counts| TAU / f64::from(counts));
    let mut model = Model::new(scenario, recorded, count_rad)?;
    if !scenario.run.mode.is_hil() {
        let own = || instruments(scenario, scenario.bench.torque_per_duty_nm(), TORQUE_DELAY_US);
        model.begin_as_bench(&intervals.instruments.unwrap_or_else(own), count_rad)?;
    }
    for Quantity { name: key, estimate } in &intervals.quantities {
        let Some(Interval { value: middle, low, high }) = estimate else { continue };
        let found = scenario.plant.values.iter().find(|(name, _)| name == key);
        let Some((name, PlantValue::Number(value))) = found else { continue };
        let mut ends = [value - (middle - low), value + (high - middle)];
        if let Some((_, least)) = LEAST.into_iter().find(|(key, _)| **key == *name) {
            ends = ends.map(|end| end.max(least));
        }
        model.vary(name, ends.map(PlantValue::Number))?;
    }
    let period_s = scenario.run.control_period_s();
    let mut worst: Option<Departure> = None;
    for (step, (positions, model_rad)) in recorded.positions_rad.iter().zip(&model.positions_rad).enumerate()
    {
        for (at, encoder) in ["motor", "load"].into_iter().enumerate() {
            let distance_rad = (positions[at] - model_rad[at]).abs();
            let limit_rad = model.squares[step][at].sqrt();
            let excess = distance_rad / limit_rad;
            // NaN is never inside the limit.
            let is_inside = excess <= 1.0;
            if !is_inside && worst.is_none_or(|it| excess > it.distance_rad / it.limit_rad) {
                worst = Some(Departure { encoder, time_s: step as f64 * period_s, distance_rad, limit_rad });
            }
        }
    }
    Ok(worst)
}
