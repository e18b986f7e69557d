//! The cases of a campaign, in the order of its tables.

use lashloop_bench::scenario::{Override, Scenario, ScenarioErrors};
use serde::{Deserialize, Serialize};

use super::case::{Case, CaseId, Part};
use super::law::Law;
use super::plants::RandomPlant;
use super::sweeps::SWEEPS;

/// Settings of a campaign. Equal settings give equal runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Seed of every random stream.
    pub seed: u64,
    /// Number of random plants.
    pub plants: u32,
    /// Without repetition.
    pub laws: Vec<Law>,
    /// Whether the sweeps are included.
    pub sweeps: bool,
}

/// Every case of a campaign, in the order of the tables.
///
/// # Errors
/// A scenario refuses a setting of its case.
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

fn case(law: Law, (part, row, mut settings): (Part, u32, Vec<String>)) -> Result<Case, ScenarioErrors> {
    // A campaign varies the plant and keeps the drive.
    settings.push("meant=mismatch".to_owned());
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
            assert_eq!(case.scenario.controller.name, case.id.law.name());
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
            let have = |key| case.scenario.plant.number(key).expect(key);
            assert_eq!(have("load_inertia_kg_m2"), plant.mechanics.load_inertia_kg_m2);
            assert_eq!(have("dead_zone_rad"), plant.mechanics.dead_zone_rad);
            assert_eq!(case.scenario.encoders.load_counts_per_rev, plant.counts_per_rev);
            assert_eq!(have("load_stiction_nm"), plant.parameters.load.stiction_nm);
            assert!((have("current_lag_ms") - 1e3 * plant.parameters.current_lag_s).abs() < 1e-12);
        }
    }

    #[test]
    fn names_are_those_in_json() {
        for law in Law::ALL {
            assert_eq!(serde_json::to_value(law).expect("a word"), law.to_string());
        }
    }

    #[test]
    fn fewer_plants_are_the_first_of_more() {
        let settings = |plants| Settings { seed: 3, plants, laws: vec![Law::BEFORE], sweeps: false };
        let (few, many) = (cases(&settings(3)).expect("cases"), cases(&settings(5)).expect("cases"));
        assert_eq!(few[..], many[..3]);
    }
}
