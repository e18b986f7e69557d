//! The section `[plant]` with `model = "process"`, and a model that a program registers.

use std::path::Path;

use lashloop_bench::run::simulator::Simulator;
use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::plant::standard;
use lashloop_plant::{Key, PlantModel, PlantValue, smooth};

use crate::{SHORTEST, read};

const COMMAND: &str = "command = [\"python3\", \"plant.py\"]\n";

fn with(keys: &str) -> Result<Scenario, String> {
    read(&SHORTEST.replace("model = \"smooth\"", &format!("model = \"process\"\n{keys}")), &[])
}

#[test]
fn a_process_gets_command_limits_and_settings() {
    let settings = "[plant.settings]\nteeth = 17\nratios = [1.5, 2]\n[plant.settings.belt]\nis_new = true\n";
    let scenario = with(&format!("{COMMAND}{settings}")).expect("a good scenario");
    let plant = &scenario.plant;
    assert_eq!((plant.number("start_timeout_ms"), plant.number("step_timeout_ms")), (Some(1e4), Some(1e3)));
    let Some(PlantValue::Table(table)) = plant.values.get("settings") else { panic!("no table") };
    assert_eq!(table["ratios"], PlantValue::List(vec![PlantValue::Number(1.5), PlantValue::Integer(2)]));
    assert!(matches!(&table["belt"], PlantValue::Table(belt) if belt["is_new"] == PlantValue::Boolean(true)));
    let printed = scenario.to_toml().expect("TOML");
    assert_eq!(read(&printed, &[]).expect(&printed).plant, scenario.plant, "{printed}");
}

#[test]
fn errors_of_a_process_plant_name_their_key() {
    let cases = [
        ("", "x.toml:4: plant.command: is missing; it must be a list of texts in quotes, at least one"),
        ("command = []", "plant.command: [0 items] is empty; it must have at least one text"),
        (
            "command = \"plant.py\"",
            "plant.command: \"plant.py\" is text; it must be a list of texts in quotes",
        ),
        ("command = [\"a\"]\nstep_timeout_ms = 0", "0 is out of range; it must be >= 1 and <= 600000 ms"),
        (
            "command = [\"a\"]\nsettings = 1",
            "plant.settings: 1 is a whole number; it must be a section [plant.settings]",
        ),
        ("command = [\"a\"]\nload_inertia_kg_m2 = 1", "this key belongs to model = \"smooth\""),
    ];
    for (keys, want) in cases {
        let have = with(keys).expect_err(keys);
        assert!(have.contains(want), "have {have}\nwant {want}");
    }
}

#[test]
fn an_fmu_needs_its_file_and_three_variables() {
    let with =
        |keys: &str| read(&SHORTEST.replace("model = \"smooth\"", &format!("model = \"fmu\"\n{keys}")), &[]);
    let needed = "file = \"a.fmu\"\ntorque_input = \"tau\"\nmotor_output = \"motor.phi\"\nload_output = \"load.phi\"\n";
    for key in needed.lines() {
        let name = key.split(' ').next().expect("a name");
        let have = with(&needed.replace(key, "")).expect_err(name);
        let want = format!("x.toml:4: plant.{name}: is missing; it must be a text in quotes");
        assert_eq!(have, want);
    }
    let have = with(&format!("{needed}signals = \"twist\"")).expect_err("a text");
    assert!(
        have.contains("plant.signals: \"twist\" is text; it must be a list of texts in quotes"),
        "{have}"
    );
    let start = "[plant.start]\n\"motor.start\" = 1.5\nis_wet = true\nnote = \"dry\"\n";
    let scenario = with(&format!("{needed}{start}")).expect("a good scenario");
    assert_eq!(scenario.plant.values.texts("files"), Ok(Vec::new()));
    let printed = scenario.to_toml().expect("TOML");
    assert_eq!(read(&printed, &[]).expect(&printed).plant, scenario.plant, "{printed}");
}

#[test]
fn a_plant_that_takes_no_change_refuses_its_faults() {
    let fault = "[[fault]]\nat_s = 0.5\nkind = \"load-torque\"\ntorque_nm = 1\n";
    let text = SHORTEST.replace("model = \"smooth\"", &format!("model = \"process\"\n{COMMAND}")) + fault;
    let have = read(&text, &[]).expect_err("a fixed plant");
    let want = "\"load-torque\" needs plant.model = \"backlash-shaft\": process takes no such change";
    assert!(have.contains(want), "{have}");
}

#[test]
fn the_example_runs_in_the_folder_of_its_scenario() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/plant-process/plant.toml");
    let scenario = Scenario::from_file(&path, &[]).unwrap_or_else(|errors| panic!("{errors}"));
    let simulator = Simulator::new(&scenario).expect("python3");
    let names: Vec<_> = simulator.signals().iter().map(|signal| &*signal.name).collect();
    assert_eq!(names, ["twist_rad", "transmitted_torque_nm", "dead_zone_rad"]);
}

#[test]
fn a_registered_key_has_the_unit_that_its_model_declares() {
    let keys = vec![Key::number("belt_tension_kn", "kN", None, 0.0..=5.0, "Tension of the belt.")];
    let plants = standard().with(PlantModel::new("belt", "A belt.", keys, |release| {
        smooth::model().release(&lashloop_plant::Release { values: &smooth::model().defaults(), ..*release })
    }));
    let text = SHORTEST.replace("\"smooth\"", "\"belt\"");
    let with = |text: &str| {
        Scenario::from_str_with("x.toml", text, &[], &plants).map_err(|errors| errors.to_string())
    };
    let missing = with(&text).expect_err("a required key");
    let want = "x.toml:4: plant.belt_tension_kn: is missing; it must be a number >= 0 and <= 5 kN";
    assert_eq!(missing, want);
    let given = with(&text.replace("\"belt\"", "\"belt\"\nbelt_tension_kn = 2.5")).expect("a good scenario");
    assert_eq!(given.plant.number("belt_tension_kn"), Some(2.5));
    Simulator::new(&given).expect("a plant");
}
