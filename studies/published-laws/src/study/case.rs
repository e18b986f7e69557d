//! One run and its figures.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::string::{String, ToString};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::vec::Vec;
use std::{format, thread};

use anyhow::{Context, Result};
use battery::campaign::{Battery, RANDOM_PLANTS};
use battery::plants::{RandomPlant, RandomPlants};
use lashloop::{Bench, Outcome, run};
use lashloop_firmware::law::LawSet;

use super::hard::Machine;
use super::laws::Law;
use crate::PublishedLaws;

/// The plant of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plant {
    Nominal,
    Random {
        seed: u64,
        index: u32,
    },
    /// Of a part of the harder battery.
    Hard {
        part: &'static str,
        seed: u64,
        index: u32,
    },
}

/// The parts of the harder battery that are compared.
pub const HARD_PARTS: [&str; 2] = ["random-hard", "random-all"];
/// Seeds of that comparison, and plants of each.
const HARD_SEEDS: [u64; 2] = [101, 102];
const HARD_PLANTS: u32 = 50;

/// The plants of the comparison on a part of the harder battery.
#[must_use]
pub fn hard_plants(part: &'static str) -> Vec<Plant> {
    let of = |seed| (0..HARD_PLANTS).map(move |index| Plant::Hard { part, seed, index });
    HARD_SEEDS.into_iter().flat_map(of).collect()
}

type Plants = Arc<RandomPlants>;

/// The random plants of a part and a seed. Their campaign takes longer to read than a run does.
fn random_plants(battery: Battery, part: &'static str, seed: u64) -> Result<Plants> {
    static READ: Mutex<BTreeMap<(&str, u64), Plants>> = Mutex::new(BTreeMap::new());
    let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(plants) = read.get(&(part, seed)) {
        return Ok(plants.clone());
    }
    let plants = Arc::new(RandomPlants::of(battery, part, seed)?);
    read.insert((part, seed), plants.clone());
    Ok(plants)
}

impl Plant {
    fn random(self) -> Result<Option<(Plants, u32)>> {
        let (battery, part, seed, index) = match self {
            Self::Nominal => return Ok(None),
            Self::Random { seed, index } => (Battery::Standard, RANDOM_PLANTS, seed, index),
            Self::Hard { part, seed, index } => (Battery::Hard, part, seed, index),
        };
        Ok(Some((random_plants(battery, part, seed)?, index)))
    }
}

/// Duration of a run in s, that of the scenarios.
const DURATION_S: f64 = 25.0;
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
    /// The settling time over the shortest one of the plant; `None` outside the harder battery.
    pub over_minimum: Option<f64>,
    /// One count of the load encoder.
    pub count_rad: f64,
}

impl Figures {
    fn of(outcome: &Outcome, count_rad: f64, minimum_s: Option<f64>) -> Self {
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
            over_minimum: minimum_s.map(|minimum_s| metric("settle_time_s") / minimum_s),
            count_rad,
        }
    }
}

/// The settings of a plant without those of parameters that a law lacks.
fn known_to(law: &Law, random: &RandomPlant<'_>) -> Vec<String> {
    let index = PublishedLaws::NAMES.iter().position(|name| *name == law.name);
    let has = |name: &str| {
        let mut parameters = PublishedLaws::PARAMETERS.iter();
        parameters.any(|it| it.name == name && index.is_some_and(|index| it.laws & 1 << index != 0))
    };
    let key = |setting: &String| setting.split('=').next().unwrap_or_default().to_string();
    let parameter = |setting: &String| key(setting).strip_prefix("controller.parameters.").map(has);
    random.settings().into_iter().filter(|setting| parameter(setting) != Some(false)).collect()
}

/// Runs a law on a plant. `values` are those of its tuned parameters at the nominal machine; by default it
/// has those of its scenario, and at another machine those for the harder battery.
///
/// # Errors
/// The scenario refuses a setting, or the run can't be carried out.
pub fn figures(law: &Law, plant: Plant, values: Option<&[f64]>, duration_s: f64) -> Result<Figures> {
    let bench = Bench::new().with_laws::<PublishedLaws>();
    // A scenario's expectations are about its own plant. The drive has the nominal model on every plant of the battery.
    let mut all = ["expect=[]", "meant=[\"mismatch\"]"].map(str::to_string).to_vec();
    all.push(format!("run.duration_s={duration_s:?}"));
    let mut counts = NOMINAL_COUNTS;
    let mut minimum_s = None;
    let plants = plant.random()?;
    let random = plants.as_ref().map(|(plants, index)| plants.plant(*index)).transpose()?;
    if let Some(random) = &random {
        let drawn = random.number("encoders.load_counts_per_rev").context("a plant has encoders")?;
        counts = drawn as u32;
        all.extend(known_to(law, random));
        if matches!(plant, Plant::Hard { .. }) {
            minimum_s = Some(random.minimum_settle_time_s().context("a motor that moves the load")?);
        }
    }
    let machine = Machine::of(random.as_ref());
    if let Some(values) = values.or((machine != Machine::of(None)).then_some(law.hard)) {
        all.extend(machine.settings(law.tuned, values));
    }
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    let scenario = bench.scenario_from_str(law.scenario, &all).with_context(|| law.name.to_string())?;
    let outcome =
        run(&scenario, &bench.device("inproc")?).with_context(|| format!("{} on {plant:?}", law.name))?;
    Ok(Figures::of(&outcome, TAU / f64::from(counts), minimum_s))
}

/// Figures of a law on several plants, in their order, from all processors.
///
/// # Errors
/// As [`figures`].
pub fn figures_on(law: &Law, plants: &[Plant]) -> Result<Vec<Figures>> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some((at, plant)) =
            Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|at| Some((at, plants.get(at)?)))
        {
            done.push((at, figures(law, *plant, None, DURATION_S)));
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
