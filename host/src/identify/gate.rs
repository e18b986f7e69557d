//! Whether the plant model of a scenario follows the recorded motion.
//!
//! The model is fed with the recorded torque. If its motion leaves the recorded one by more than encoders and intervals
//! explain, the run doesn't judge the law: it ran on another plant. The band of a sample is one count of the encoder, and
//! the root of the sum of squares of what each parameter moves within its interval.

use std::fmt;
use std::path::Path;

use lashloop_bench::record::columns::Columns;
use lashloop_bench::run::simulator::Simulator;
use lashloop_bench::run::{RunError, Step};
use lashloop_bench::scenario::Scenario;
use lashloop_plant::PlantValue;
use serde::Deserialize;

use std::f64::consts::TAU;
use std::{fs, io};

/// Torques and positions of a run.
#[derive(Debug, Clone, Default)]
pub struct RecordedMotion {
    torque_nm: Vec<f32>,
    /// Motor and load.
    positions_rad: Vec<[f64; 2]>,
}

impl RecordedMotion {
    /// Takes a finished step.
    pub fn push(&mut self, step: &Step) {
        // The drive's own torque, which came as f32.
        self.torque_nm.push(step.row.torque_nm as f32);
        self.positions_rad.push([step.row.motor_position_rad, step.row.load_position_rad]);
    }

    /// The motion of a record; `None` if a column is missing.
    #[must_use]
    pub fn of(columns: &Columns) -> Option<Self> {
        let positions = columns.get("motor_position_rad")?.iter().zip(columns.get("load_position_rad")?);
        Some(Self {
            torque_nm: columns.get("torque_nm")?.iter().map(|&torque_nm| torque_nm as f32).collect(),
            positions_rad: positions.map(|(&motor, &load)| [motor, load]).collect(),
        })
    }
}

/// The interval of one key of the plant.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyInterval {
    key: String,
    below: f64,
    above: f64,
}

/// The part of `estimates.json` that the gate reads.
#[derive(Deserialize)]
struct Estimates {
    quantities: Vec<Quantity>,
}

#[derive(Deserialize)]
struct Quantity {
    name: String,
    estimate: Option<Interval>,
}

#[derive(Deserialize)]
struct Interval {
    value: f64,
    low: f64,
    high: f64,
}

/// Reads the intervals of `estimates.json`.
///
/// # Errors
/// The file can't be read or isn't a file of `identify` or `commission`.
pub fn intervals(path: &Path) -> io::Result<Vec<KeyInterval>> {
    let estimates: Estimates = serde_json::from_slice(&fs::read(path)?).map_err(|error| {
        io::Error::other(format!(
            "it is no estimates.json of `lashloop commission` or `lashloop identify`: {error}"
        ))
    })?;
    let interval = |Quantity { name: key, estimate }| {
        let Interval { value, low, high } = estimate?;
        Some(KeyInterval { key, below: value - low, above: high - value })
    };
    Ok(estimates.quantities.into_iter().filter_map(interval).collect())
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
    intervals: &[KeyInterval],
) -> Result<Option<Departure>, RunError> {
    let model = replay(scenario, recorded)?;
    let mut squares = vec![[0.0; 2]; model.len()];
    for KeyInterval { key, below, above } in intervals {
        let found = scenario.plant.values.iter().find(|(name, _)| name == key);
        let Some((name, PlantValue::Number(value))) = found else { continue };
        let mut largest = vec![[0.0_f64; 2]; model.len()];
        for end in [value - below, value + above] {
            let mut altered = scenario.clone();
            altered.plant.values.insert(name, PlantValue::Number(end));
            for ((largest, moved), model) in largest.iter_mut().zip(replay(&altered, recorded)?).zip(&model) {
                for encoder in 0..2 {
                    largest[encoder] = largest[encoder].max((moved[encoder] - model[encoder]).abs());
                }
            }
        }
        for (square, largest) in squares.iter_mut().zip(largest) {
            for encoder in 0..2 {
                square[encoder] += largest[encoder].powi(2);
            }
        }
    }
    let encoders = &scenario.encoders;
    let count_rad =
        [encoders.motor_counts_per_rev, encoders.load_counts_per_rev].map(|counts| TAU / f64::from(counts));
    let period_s = scenario.run.control_period_s();
    let mut worst: Option<Departure> = None;
    for (step, (positions, model)) in recorded.positions_rad.iter().zip(&model).enumerate() {
        for (at, encoder) in ["motor", "load"].into_iter().enumerate() {
            let distance_rad = (positions[at] - model[at]).abs();
            let limit_rad = (count_rad[at].powi(2) + squares[step][at]).sqrt();
            let excess = distance_rad / limit_rad;
            // A position that is no number is no position of the model either.
            let is_inside = excess <= 1.0;
            if !is_inside && worst.is_none_or(|it| excess > it.distance_rad / it.limit_rad) {
                worst = Some(Departure { encoder, time_s: step as f64 * period_s, distance_rad, limit_rad });
            }
        }
    }
    Ok(worst)
}

/// Positions of the scenario's plant under the recorded torques.
fn replay(scenario: &Scenario, recorded: &RecordedMotion) -> Result<Vec<[f64; 2]>, RunError> {
    let mut simulator = Simulator::new(scenario)?;
    let mut positions = Vec::with_capacity(recorded.torque_nm.len());
    for (step, &torque_nm) in (0..).zip(&recorded.torque_nm) {
        let (_, observation) = simulator.observe(step)?;
        positions.push([observation.row.motor_position_rad, observation.row.load_position_rad]);
        simulator.step(step, torque_nm)?;
    }
    Ok(positions)
}
