//! The section `[plant]` with `model = "backlash-shaft"`: defaults, intervals and errors.

use std::path::Path;

use lashloop_bench::scenario::Scenario;
use lashloop_plant::Environment;
use lashloop_plant::backlash_shaft::ShaftParameters;

use crate::read;

const BENCH: &str = r#"title = "a run"
[run]
duration_s = 2.0
[plant]
model = "backlash-shaft"
[controller]
name = "pd"
[reference]
profile = "constant"
position_rad = 0.0
"#;

fn with(keys: &str) -> Result<Scenario, String> {
    read(&BENCH.replace("model = \"backlash-shaft\"", &format!("model = \"backlash-shaft\"\n{keys}")), &[])
}

#[test]
fn the_default_bench_stands_for_the_experiment_of_the_paper() {
    let scenario = with("").expect("a good scenario");
    let plant = scenario.plant;
    let number = |key| plant.number(key).expect(key);
    let paper = ShaftParameters::paper();
    assert_eq!(number("substeps"), 16.0);
    assert_eq!(number("shaft_damping_nm_s_rad"), paper.shaft_damping_nm_s_rad);
    let load = ["load_coulomb_nm", "load_stiction_nm", "load_stribeck_rad_s"].map(number);
    assert_eq!(load, [paper.load.coulomb_nm, paper.load.stiction_nm, paper.load.velocity_rad_s]);
    let motor = ["motor_coulomb_nm", "motor_stiction_nm", "motor_stribeck_rad_s"].map(number);
    assert_eq!(motor, [paper.motor.coulomb_nm, paper.motor.stiction_nm, paper.motor.velocity_rad_s]);
    assert_eq!((number("current_lag_ms"), plant.torque_delay_us()), (0.5, 1000));
    assert_eq!(number("torque_saturation_nm"), paper.torque_saturation_nm);
    assert_eq!(plant.values.text("load_friction"), Ok("stribeck"));
    assert_eq!(plant.number("bristle_stiffness_nm_rad"), None);
    assert_eq!(plant.environment.expect("wear and load torque").at(1.0), Environment::default());
}

#[test]
fn a_bench_that_was_read_can_be_printed_and_read_again() {
    for keys in ["", "load_friction = \"lugre\"\n[plant.wear]\ngrowth_rad = 0.1\nfrom_s = 0.5"] {
        let scenario = with(keys).expect("a good scenario");
        let printed = scenario.to_toml().expect("TOML");
        assert_eq!(read(&printed, &[]).expect("a good scenario").plant, scenario.plant, "{printed}");
    }
}

#[test]
fn errors_of_a_shaft_plant_name_their_key() {
    let faults = [
        "load_stiction_nm = 3.0",
        "motor_coulomb_nm = 0.03",
        "bristle_stiffness_nm_rad = 1e4",
        "load_friction = \"dahl\"",
        "load_friction_asymmetry = 1.5",
        "torque_delay_ms = 1",
        "[plant.load_torque]\ntorque_nm = 1\nfrom_s = 3\nuntil_s = 2",
        "[plant.wear]\ngrowth_rad = -0.1",
    ];
    let messages = faults.map(|keys| format!("| {keys}\n{}\n", with(keys).expect_err(keys)));
    let elsewhere = BENCH.replace("\"backlash-shaft\"", "\"smooth\"\nshaft_damping_nm_s_rad = 0.1");
    let messages = format!(
        "{}| on the smooth plant\n{}",
        messages.concat(),
        read(&elsewhere, &[]).expect_err("no shaft")
    );
    insta::assert_snapshot!(messages);
}

#[test]
fn wear_and_load_torque_keep_to_their_intervals() {
    let keys = "[plant.wear]\ngrowth_rad = 0.2\nfrom_s = 1\nuntil_s = 3\n\
                [plant.load_torque]\ntorque_nm = -4\nfrom_s = 1\nuntil_s = 3";
    let environment = with(keys).expect("a good scenario").plant.environment.expect("an environment");
    let growth_rad = |time_s| environment.at(time_s).gap_growth_rad;
    assert_eq!([0.0, 1.0, 2.0, 3.0, 9.0].map(growth_rad), [0.0, 0.0, 0.1, 0.2, 0.2]);
    let torque_nm = |time_s| environment.at(time_s).load_torque_nm;
    assert_eq!([0.0, 1.0, 2.9, 3.0].map(torque_nm), [0.0, -4.0, -4.0, 0.0]);
}

#[test]
fn every_scenario_of_the_bench_is_right_and_expects_something() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("the scenarios") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
        if !name.starts_with("shaft-") || !name.ends_with(".toml") {
            continue;
        }
        let scenario = Scenario::from_file(&path, &[]).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(scenario.plant.model.name(), "backlash-shaft", "{name}");
        assert!(!scenario.expectations.is_empty(), "{name}");
        assert_eq!(scenario.encoders.load_counts_per_rev, 4000, "{name}");
        seen += 1;
    }
    assert!(seen >= 8, "{seen} scenarios");
}
