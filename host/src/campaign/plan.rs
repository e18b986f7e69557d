//! Which runs a battery consists of, in the order of its tables.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::plants::RandomPlant;
use super::sweeps::SWEEPS;
use lashloop_bench::scenario::{Override, Scenario, ScenarioErrors};

/// A control law that is put to the test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// The paper's cascade before compensation.
    Pd,
    /// The paper's cascade with compensation.
    Merzouki,
    /// The gap inverted in the torque domain and identified.
    BacklashInverse,
}

impl Law {
    /// Every law, in the order of the tables.
    pub const ALL: [Self; 3] = [Self::Pd, Self::Merzouki, Self::BacklashInverse];

    /// The name in scenarios.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pd => "pd",
            Self::Merzouki => "merzouki",
            Self::BacklashInverse => "backlash-inverse",
        }
    }

    /// The scenario that its runs are made of: file and text. The drive's parameters in it are those of the nominal plant
    /// and stay what they are.
    const fn scenario(self) -> (&'static str, &'static str) {
        match self {
            Self::Pd => ("scenarios/shaft-pd.toml", include_str!("../../../scenarios/shaft-pd.toml")),
            Self::Merzouki => {
                ("scenarios/shaft-merzouki.toml", include_str!("../../../scenarios/shaft-merzouki.toml"))
            }
            Self::BacklashInverse => (
                "scenarios/shaft-backlash-inverse.toml",
                include_str!("../../../scenarios/shaft-backlash-inverse.toml"),
            ),
        }
    }
}

impl fmt::Display for Law {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(self.name())
    }
}

impl FromStr for Law {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let law = Self::ALL.into_iter().find(|law| law.name() == text);
        law.ok_or_else(|| "expected pd, merzouki or backlash-inverse".to_owned())
    }
}

/// What a battery is made of. The same settings give the same runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Starts every random stream.
    pub seed: u64,
    /// Number of random plants.
    pub plants: u32,
    /// The laws, each once.
    pub laws: Vec<Law>,
    /// Whether the sweeps are run as well.
    pub sweeps: bool,
}

/// A part of the battery: a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Plants nobody tuned a controller for.
    RandomPlants,
    /// The nominal plant with another gap.
    DeadZone,
    /// The nominal plant behind other encoders.
    EncoderCounts,
    /// The nominal plant with another limit of the drive's torque.
    TorqueLimit,
    /// The nominal plant with another delay of the torque.
    TorqueDelay,
}

impl Part {
    /// The name in records.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RandomPlants => "random-plants",
            Self::DeadZone => "dead-zone",
            Self::EncoderCounts => "encoder-counts",
            Self::TorqueLimit => "torque-limit",
            Self::TorqueDelay => "torque-delay",
        }
    }
}

/// Where a run belongs: the table, its row from 0, and the law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseId {
    /// The table.
    pub part: Part,
    /// The number of the plant or of the value.
    pub row: u32,
    /// The law.
    pub law: Law,
}

/// One run to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Where it belongs.
    pub id: CaseId,
    /// What is other than in the law's scenario, as `--set` takes it.
    pub settings: Vec<String>,
    /// The run.
    pub scenario: Scenario,
}

impl fmt::Display for CaseId {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { part, row, law } = self;
        write!(out, "{law} in row {row} of {}", part.name())
    }
}

/// Every run of a battery, in the order of the tables.
///
/// # Errors
/// A scenario does not take what the battery sets in it.
pub fn cases(settings: &Settings) -> Result<Vec<Case>, ScenarioErrors> {
    let plants = (0..settings.plants).map(|row| {
        let plant = RandomPlant::draw(settings.seed, row);
        (Part::RandomPlants, row, plant.settings())
    });
    let sweeps = SWEEPS.iter().filter(|_| settings.sweeps).flat_map(|sweep| {
        (0..).zip(sweep.values).map(|(row, &value)| (sweep.part, row, sweep.settings(value)))
    });
    let rows = plants.chain(sweeps);
    rows.flat_map(|row| settings.laws.iter().map(move |&law| case(law, row.clone()))).collect()
}

fn case(law: Law, (part, row, settings): (Part, u32, Vec<String>)) -> Result<Case, ScenarioErrors> {
    let (name, text) = law.scenario();
    let overrides: Vec<_> = settings.iter().cloned().map(Override::Set).collect();
    let scenario = Scenario::from_str(name, text, &overrides)?;
    Ok(Case { id: CaseId { part, row, law }, settings, scenario })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_s_scenario_is_that_law_s() {
        let settings = Settings { seed: 1, plants: 1, laws: Law::ALL.to_vec(), sweeps: false };
        for case in cases(&settings).expect("cases") {
            assert_eq!(case.scenario.controller.name.name(), case.id.law.name());
        }
    }

    #[test]
    fn a_plant_differs_from_the_law_s_scenario_and_the_drive_s_parameters_do_not() {
        let settings = Settings { seed: 1, plants: 1, laws: Law::ALL.to_vec(), sweeps: false };
        for case in cases(&settings).expect("cases") {
            let (name, text) = case.id.law.scenario();
            let nominal = Scenario::from_str(name, text, &[]).expect("the law's scenario");
            assert_eq!(case.scenario.controller, nominal.controller);
            let plant = RandomPlant::draw(1, 0);
            let have = &case.scenario.plant;
            assert_eq!(have.load_inertia_kg_m2, plant.mechanics.load_inertia_kg_m2);
            assert_eq!(have.dead_zone_rad, plant.mechanics.dead_zone_rad);
            assert_eq!(case.scenario.encoders.load_counts_per_rev, plant.counts_per_rev);
            let bench = have.backlash_shaft.as_ref().expect("the bench plant");
            assert_eq!(bench.load_stiction_nm, plant.parameters.load.stiction_nm);
            assert!((bench.current_lag_ms - 1e3 * plant.parameters.current_lag_s).abs() < 1e-12);
        }
    }

    #[test]
    fn names_are_those_in_json() {
        for part in SWEEPS.iter().map(|sweep| sweep.part).chain([Part::RandomPlants]) {
            assert_eq!(serde_json::to_value(part).expect("a word"), part.name());
        }
        for law in Law::ALL {
            assert_eq!(serde_json::to_value(law).expect("a word"), law.name());
        }
    }

    #[test]
    fn fewer_plants_are_the_first_of_more() {
        let settings = |plants| Settings { seed: 3, plants, laws: vec![Law::Pd], sweeps: false };
        let (few, many) = (cases(&settings(3)).expect("cases"), cases(&settings(5)).expect("cases"));
        assert_eq!(few[..], many[..3]);
    }
}
