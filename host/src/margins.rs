//! How far a machine may differ from the one that its drive is told of, by simulation of the whole loop.
//!
//! A margin is a property of law, plant, encoders and saturation together, so it is searched for where it matters: one
//! quantity of the plant leaves its value step by step until the load no longer settles, or hunts.

use std::f64::consts::TAU;
use std::fmt::{self, Display, Formatter};

use lashloop_bench::run::End as RunEnd;
use lashloop_bench::scenario::{RunMode, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_plant::PlantValue;
use lashloop_plant::metrics::Metric;

use crate::{Bench, Error, Execution};

/// Factor from one trial to the next, the number of trials, and the number of bisections after the first that fails.
const STEP: f64 = 1.3;
const TRIALS: u32 = 8;
const BISECTIONS: usize = 3;
/// Largest delay that a plant has.
const LARGEST_DELAY_US: f64 = 1e6;
/// Shortest run: hunting is that of the last 10 s.
const LEAST_DURATION_S: f64 = 25.0;
/// Hunting that counts as rest, in counts of the load encoder.
const REST_COUNTS: f64 = 2.0;

/// A quantity of the plant that a margin is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Varied {
    /// Inertia of the load.
    LoadInertia,
    /// Stiffness of the transmission.
    Stiffness,
    /// Delay from a sample to its torque.
    TorqueDelay,
}

impl Varied {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::LoadInertia, Self::Stiffness, Self::TorqueDelay];

    /// The key of the plant.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::LoadInertia => "load_inertia_kg_m2",
            Self::Stiffness => "stiffness_nm_rad",
            Self::TorqueDelay => "torque_delay_us",
        }
    }
}

/// The end of a range in which the load settles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// The load still settles at this value, and no longer a little beyond.
    At(f64),
    /// It settles at every value that was tried, up to this one.
    Beyond(f64),
}

/// The range of a quantity in which the load settles: factors, or us of additional delay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margin {
    /// The quantity.
    pub of: Varied,
    /// Lower end; `None` for a delay, which has none.
    pub least: Option<End>,
    /// Upper end.
    pub most: End,
}

impl Display for Margin {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let end = |end: End, beyond: &str| match end {
            End::At(factor) => format!("x {factor:.2}"),
            End::Beyond(factor) => format!("{beyond} x {factor:.2}"),
        };
        match (self.least, self.most) {
            (Some(least), most) => {
                write!(f, "{} {} to {}", self.of.key(), end(least, "below"), end(most, "beyond"))
            }
            (None, End::At(us)) => write!(f, "{} up to +{:.1} ms", self.of.key(), us / 1e3),
            (None, End::Beyond(us)) => write!(f, "{} beyond +{:.1} ms", self.of.key(), us / 1e3),
        }
    }
}

/// What a simulation of the loop shows.
#[derive(Debug)]
pub struct Margins {
    /// How the run with the plant as stated ended.
    pub end: RunEnd,
    /// Time in s until the load stays within 5 % of its move; `None` if it doesn't, or hunts.
    pub settle_time_s: Option<f64>,
    /// A margin for each quantity; none if the stated plant doesn't settle.
    pub margins: Vec<Margin>,
}

/// Why a simulation shows nothing.
enum Stop {
    Interrupted,
    Failed(Error),
}

impl<E: Into<Error>> From<E> for Stop {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// Simulates the scenario in HIL mode with the laws of this program, as it is and with other plants. Its expectations and
/// faults have no effect. `None` if a signal of the user ends the search.
///
/// # Errors
/// A run failed.
pub fn margins(
    bench: &Bench,
    supervisor: &Supervisor,
    scenario: &Scenario,
) -> Result<Option<Margins>, Error> {
    let mut stated = scenario.clone();
    stated.run.mode = RunMode::Hil;
    stated.run.duration_s = stated.run.duration_s.max(LEAST_DURATION_S);
    stated.expectations.clear();
    stated.faults.clear();
    match (Search { bench, supervisor, stated }).margins() {
        Ok(margins) => Ok(Some(margins)),
        Err(Stop::Interrupted) => Ok(None),
        Err(Stop::Failed(error)) => Err(error),
    }
}

struct Search<'a> {
    bench: &'a Bench,
    supervisor: &'a Supervisor,
    stated: Scenario,
}

impl Search<'_> {
    fn margins(&self) -> Result<Margins, Stop> {
        let Run { end, settle_time_s } = self.run(&self.stated)?;
        let mut margins = Vec::new();
        for of in Varied::ALL.into_iter().filter(|_| settle_time_s.is_some()) {
            margins.extend(self.margin(of)?);
        }
        Ok(Margins { end, settle_time_s, margins })
    }

    /// `None` if the plant has no such number.
    fn margin(&self, of: Varied) -> Result<Option<Margin>, Stop> {
        let Some(now) = self.stated.plant.number(of.key()) else { return Ok(None) };
        let factor = |step: f64| STEP.powf(step);
        let margin = match of {
            Varied::TorqueDelay => {
                let period_us = f64::from(self.stated.run.control_period_us);
                // Whole microseconds: 1, 3, 7, 15 periods and so on.
                let added_us = |step: f64| (period_us * (step.exp2() - 1.0)).round();
                let possible = (1..=TRIALS).filter(|it| now + added_us(f64::from(*it)) <= LARGEST_DELAY_US);
                let settles = |added_us: f64| self.settles(of, PlantValue::Integer((now + added_us) as i64));
                Margin { of, least: None, most: end(possible.count() as u32, added_us, settles)? }
            }
            Varied::LoadInertia | Varied::Stiffness => {
                let settles = |factor: f64| self.settles(of, PlantValue::Number(now * factor));
                let least = end(TRIALS, |step| factor(-step), settles)?;
                Margin { of, least: Some(least), most: end(TRIALS, factor, settles)? }
            }
        };
        Ok(Some(margin))
    }

    fn settles(&self, of: Varied, value: PlantValue) -> Result<bool, Stop> {
        let mut scenario = self.stated.clone();
        scenario.plant.values.insert(of.key(), value);
        Ok(self.run(&scenario)?.settle_time_s.is_some())
    }

    fn run(&self, scenario: &Scenario) -> Result<Run, Stop> {
        let device = self.bench.device("inproc")?;
        let outcome = Execution::new(scenario.clone(), (&device).into()).run(self.supervisor)?.outcome;
        if outcome.end == RunEnd::Interrupted || self.supervisor.interrupted() {
            return Err(Stop::Interrupted);
        }
        let value = |metric: Metric| outcome.metrics.get(metric).value();
        let rests = value(Metric::Hunting).is_some_and(|hunting_rad| hunting_rad <= rest_rad(scenario));
        let settle_time_s = value(Metric::SettleTime5Pct).filter(|_| rests);
        Ok(Run { end: outcome.end, settle_time_s })
    }
}

struct Run {
    end: RunEnd,
    settle_time_s: Option<f64>,
}

/// Hunting in rad up to which a load counts as at rest: its encoder shows two counts, and its noise on top.
#[must_use]
pub fn rest_rad(scenario: &Scenario) -> f64 {
    let encoders = &scenario.encoders;
    let noise_counts = encoders.load_noise_counts.unwrap_or(encoders.noise_counts);
    (REST_COUNTS + 2.0 * noise_counts) * TAU / f64::from(encoders.load_counts_per_rev)
}

/// The last value of the steps from 1 on that settles; at step 0 it does.
fn end(
    trials: u32,
    value: impl Fn(f64) -> f64,
    settles: impl Fn(f64) -> Result<bool, Stop>,
) -> Result<End, Stop> {
    let (mut good, mut bad) = (0.0, None);
    for trial in (1..=trials).map(f64::from) {
        if !settles(value(trial))? {
            bad = Some(trial);
            break;
        }
        good = trial;
    }
    let Some(mut bad) = bad else { return Ok(End::Beyond(value(good))) };
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (good + bad);
        if settles(value(middle))? {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Ok(End::At(value(good)))
}
