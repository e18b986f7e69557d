//! How far a machine may differ from the one that its drive is told of, by simulation of the whole loop.
//!
//! A margin is a property of law, plant, encoders and saturation together, so it is searched for where it matters: one
//! quantity of the plant leaves its value step by step until the load no longer settles, or hunts.

use std::f64::consts::TAU;
use std::fmt::{self, Display, Formatter};

use lashloop_bench::scenario::{Override, Scenario};

use crate::{Bench, Error, Outcome, run};

/// Factor from one trial to the next, the number of trials, and the number of bisections after the first that fails.
const STEP: f64 = 1.3;
const TRIALS: u32 = 8;
const BISECTIONS: usize = 3;
/// Hunting that counts as rest, in counts of the load encoder.
const REST_COUNTS: f64 = 2.0;
/// Metric that has a value once the load has settled.
const SETTLED: &str = "settle_time_5pct_s";

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
    /// The run with the plant as it is stated.
    pub outcome: Outcome,
    /// Time in s until the load stays within 5 % of its move; `None` if it doesn't, or hunts.
    pub settle_time_s: Option<f64>,
    /// A margin for each quantity; none if the stated plant doesn't settle.
    pub margins: Vec<Margin>,
}

/// Simulates the scenario in HIL mode with the laws of this program, as it is and with other plants. `name` is the file's name
/// in errors, and relative paths start at its folder.
///
/// # Errors
/// The scenario is wrong, or a run failed.
pub fn margins(bench: &Bench, name: &str, text: &str) -> Result<Margins, Error> {
    let search = Search { bench, name, text };
    let stated = search.scenario(&[])?;
    let outcome = search.run(&stated)?;
    let settle_time_s = settle_time_s(&stated, &outcome);
    let margins = match settle_time_s {
        Some(_) => Varied::ALL
            .into_iter()
            .filter_map(|of| search.margin(&stated, of).transpose())
            .collect::<Result<_, _>>()?,
        None => Vec::new(),
    };
    Ok(Margins { outcome, settle_time_s, margins })
}

struct Search<'a> {
    bench: &'a Bench,
    name: &'a str,
    text: &'a str,
}

impl Search<'_> {
    fn scenario(&self, settings: &[String]) -> Result<Scenario, Error> {
        let fixed = ["expect=[]", r#"meant=["start", "mismatch", "large-angle"]"#].map(str::to_owned);
        let settings = fixed.into_iter().chain(settings.iter().cloned()).map(Override::Set);
        let overrides: Vec<_> = [Override::Mode("hil".to_owned())].into_iter().chain(settings).collect();
        Ok(Scenario::from_str_with(self.name, self.text, &overrides, &self.bench.plants())?)
    }

    fn run(&self, scenario: &Scenario) -> Result<Outcome, Error> {
        run(scenario, &self.bench.device("inproc")?)
    }

    /// `None` if the plant has no such number.
    fn margin(&self, stated: &Scenario, of: Varied) -> Result<Option<Margin>, Error> {
        let settles = |value: f64| self.settles(of, value);
        let margin = match of {
            Varied::TorqueDelay => {
                let period_us = f64::from(stated.run.control_period_us);
                let now_us = f64::from(stated.plant.torque_delay_us());
                // Whole microseconds: 1, 3, 7, 15 periods and so on.
                let added_us = |step: f64| (period_us * (step.exp2() - 1.0)).round();
                let most = end(added_us, |added_us| settles(now_us + added_us))?;
                Margin { of, least: None, most }
            }
            Varied::LoadInertia | Varied::Stiffness => {
                let Some(now) = stated.plant.number(of.key()) else { return Ok(None) };
                let factor = |step: f64| STEP.powf(step);
                let least = end(|step| factor(-step), |factor| settles(now * factor))?;
                let most = end(factor, |factor| settles(now * factor))?;
                Margin { of, least: Some(least), most }
            }
        };
        Ok(Some(margin))
    }

    fn settles(&self, of: Varied, value: f64) -> Result<bool, Error> {
        match self.scenario(&[format!("plant.{}={value}", of.key())]) {
            Ok(scenario) => Ok(settle_time_s(&scenario, &self.run(&scenario)?).is_some()),
            // A value that no plant has ends the range too.
            Err(Error::Scenario(_)) => Ok(false),
            Err(error) => Err(error),
        }
    }
}

/// The last value of the steps from 1 on that settles; at step 0 it does.
fn end(value: impl Fn(f64) -> f64, settles: impl Fn(f64) -> Result<bool, Error>) -> Result<End, Error> {
    let (mut good, mut bad) = (0.0, None);
    for trial in (1..=TRIALS).map(f64::from) {
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

/// The settling time of a run that ended at rest.
fn settle_time_s(scenario: &Scenario, outcome: &Outcome) -> Option<f64> {
    let rest_rad = REST_COUNTS * TAU / f64::from(scenario.encoders.load_counts_per_rev);
    let hunting_rad = outcome.metric("hunting_rad").ok()?;
    (hunting_rad <= rest_rad).then(|| outcome.metric(SETTLED).ok()).flatten()
}
