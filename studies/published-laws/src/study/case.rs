//! One run and its figures.

use std::f64::consts::TAU;
use std::string::{String, ToString};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::vec::Vec;
use std::{format, thread};

use anyhow::{Context, Result};
use battery::plants::RandomPlants;
use lashloop::{Bench, Outcome, run};

use super::laws::Law;
use crate::PublishedLaws;

/// The plant of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plant {
    Nominal,
    Random { seed: u64, index: u32 },
}

/// Encoder of the nominal plant in counts per turn.
const NOMINAL_COUNTS: u32 = 4000;

/// Figures of a run, as magnitudes; infinite where the run has none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    pub settle_time_s: f64,
    pub static_error_rad: f64,
    pub overshoot_rad: f64,
    pub hunting_rad: f64,
    pub torque_variation_nm: f64,
    pub effort_nm2s: f64,
    /// `None` for a law without an estimate.
    pub dead_zone_error_rad: Option<f64>,
    /// One count of the load encoder.
    pub count_rad: f64,
}

impl Figures {
    fn of(outcome: &Outcome, count_rad: f64) -> Self {
        // A metric of a run that was cut short does not describe the run.
        let metric =
            |name| outcome.metric(name).ok().filter(|_| outcome.passed()).map_or(f64::INFINITY, f64::abs);
        let estimates = outcome.signal("drive.dead_zone_estimate_rad").is_ok();
        Self {
            settle_time_s: metric("settle_time_s"),
            static_error_rad: metric("static_error_rad"),
            overshoot_rad: metric("overshoot_rad"),
            hunting_rad: metric("hunting_rad"),
            torque_variation_nm: metric("torque_total_variation_nm"),
            effort_nm2s: metric("effort_nm2s"),
            dead_zone_error_rad: estimates.then(|| metric("dead_zone_error_rad")),
            count_rad,
        }
    }
}

/// Runs a law on a plant.
///
/// # Errors
/// The scenario refuses a setting, or the run can't be carried out.
pub fn figures(law: &Law, plant: Plant, settings: &[String]) -> Result<Figures> {
    let bench = Bench::new().with_laws::<PublishedLaws>();
    // A scenario's expectations are about its own plant. The drive has the nominal model on every plant.
    let mut all = ["expect=[]", "meant=[\"mismatch\"]"].map(str::to_string).to_vec();
    let mut counts = NOMINAL_COUNTS;
    if let Plant::Random { seed, index } = plant {
        let plants = RandomPlants::new(seed)?;
        let random = plants.plant(index)?;
        let drawn = random.number("encoders.load_counts_per_rev").context("a plant has encoders")?;
        counts = drawn as u32;
        all.extend(random.settings());
    }
    all.extend_from_slice(settings);
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    let scenario = bench.scenario_from_str(law.scenario, &all).with_context(|| law.name.to_string())?;
    let outcome =
        run(&scenario, &bench.device("inproc")?).with_context(|| format!("{} on {plant:?}", law.name))?;
    Ok(Figures::of(&outcome, TAU / f64::from(counts)))
}

/// Figures of a law on several plants, in their order, from all processors.
///
/// # Errors
/// As [`figures`].
pub fn figures_on(law: &Law, plants: &[Plant], settings: &[String]) -> Result<Vec<Figures>> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some((at, plant)) =
            Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|at| Some((at, plants.get(at)?)))
        {
            done.push((at, figures(law, *plant, settings)));
        }
        done
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let mut done: Vec<_> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    });
    done.sort_by_key(|(at, _)| *at);
    anyhow::ensure!(done.len() == plants.len(), "a thread of the study panicked");
    done.into_iter().map(|(_, figures)| figures).collect()
}
