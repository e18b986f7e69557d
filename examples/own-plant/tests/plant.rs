//! The plant against closed forms, and its scenario on the bench's simulator.

use std::path::Path;

use lashloop_bench::run::simulator::Simulator;
use lashloop_bench::scenario::plant::standard;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_plant::{Environment, Plant, PlantValue, PlantValues, Release, Start};
use own_plant::model;

const SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/three-masses.toml");

fn released(values: &PlantValues) -> Box<dyn Plant> {
    let release = Release { values, start: Start::at_rest(0.0, 0.0), period_s: 1e-3, folder: Path::new("") };
    model().release(&release).expect("a plant")
}

fn signal(plant: &dyn Plant, name: &str) -> f64 {
    let mut values = vec![0.0; plant.signals().len()];
    plant.truth(&mut values);
    values[plant.signals().iter().position(|signal| signal.name == name).expect(name)]
}

#[test]
fn motor_flies_free_until_the_first_gap_is_closed() {
    // theta = t^2 U / 2 J reaches j at t = sqrt(2 J j / U), without friction.
    let mut values = model().defaults();
    values.insert("motor_friction_nm_s_rad", PlantValue::Number(0.0));
    let (torque_nm, inertia, gap) = (0.1, 9.72e-4, 0.02_f64);
    let closed_s = (2.0 * inertia * gap / torque_nm).sqrt();
    let mut plant = released(&values);
    for k in 1..=25 {
        plant.step(torque_nm, 1e-3).expect("a step");
        let time_s = f64::from(k) * 1e-3;
        let wheel_rad = signal(&*plant, "wheel_position_rad");
        if time_s < closed_s {
            let want_rad = 0.5 * torque_nm / inertia * time_s * time_s;
            assert!((plant.positions().motor_position_rad - want_rad).abs() < 1e-12, "{k} ms");
            assert_eq!(wheel_rad, 0.0, "{k} ms");
        } else {
            assert!(wheel_rad > 0.0, "{k} ms");
        }
        // The second gap is still open.
        assert_eq!(plant.positions().load_position_rad, 0.0, "{k} ms");
    }
}

#[test]
fn energy_is_supplied_stored_or_dissipated() {
    let mut plant = released(&model().defaults());
    let mut supplied_most_j = 0.0_f64;
    for k in 0..5_000 {
        let gap_growth_rad = f64::from(k) * 1e-5;
        plant.set_environment(Environment { gap_growth_rad, load_torque_nm: 2.0 }).expect("taken");
        plant.step(if k % 500 < 250 { 3.0 } else { -3.0 }, 1e-3).expect("a step");
        let [stored_j, supplied_j, dissipated_j] =
            ["stored_energy_j", "supplied_energy_j", "dissipated_energy_j"].map(|name| signal(&*plant, name));
        supplied_most_j = supplied_most_j.max(supplied_j);
        let imbalance_j = stored_j - supplied_j + dissipated_j;
        assert!(imbalance_j.abs() < 1e-4 * supplied_j.max(1.0), "{imbalance_j} J after {k} ms");
    }
    assert!(supplied_most_j > 1.0, "the plant moved");
}

#[test]
fn the_load_stops_at_the_sum_of_both_gaps() {
    // Pushed gently and held, motor and load differ by both half gaps and the twist of both springs.
    let mut plant = released(&model().defaults());
    plant.set_environment(Environment { gap_growth_rad: 0.0, load_torque_nm: -0.3 }).expect("taken");
    for _ in 0..60_000 {
        plant.step(0.1, 1e-3).expect("a step");
    }
    let positions = plant.positions();
    let twist_rad = positions.motor_position_rad - 3.0 * positions.load_position_rad;
    assert!((twist_rad - (0.02 + 0.14 + 0.1 / 20.0 + 0.1 / 1.0)).abs() < 1e-6, "{twist_rad} rad");
}

#[test]
fn the_scenario_runs_on_the_bench() {
    let plants = standard().with(model());
    let scenario = Scenario::from_file_with(Path::new(SCENARIO), &[], &plants).expect("a good scenario");
    let mut simulator = Simulator::new(&scenario).expect("a simulator");
    assert_eq!(simulator.signals()[0].name, "wheel_position_rad");
    let (first, _) = simulator.observe(0).expect("a sample");
    for step in 0..200 {
        simulator.observe(step).expect("a sample");
        simulator.step(step, -1.0).expect("a step");
    }
    let (last, _) = simulator.observe(200).expect("a sample");
    assert!(last.motor_counts.get() < first.motor_counts.get(), "the torque turns the motor backwards");
}

#[test]
fn its_keys_are_checked_like_those_of_any_plant() {
    let plants = standard().with(model());
    let with = |setting: &str| {
        let overrides = [Override::Set(setting.to_owned())];
        Scenario::from_file_with(Path::new(SCENARIO), &overrides, &plants).expect_err(setting).to_string()
    };
    let range = with("plant.load_stage_dead_zone_rad=2");
    assert!(range.contains("2 is out of range; it must be >= 0 and <= 1 rad"), "{range}");
    let typo = with("plant.wheel_inertia=1");
    assert!(typo.contains("write wheel_inertia_kg_m2, in kg m^2"), "{typo}");
    let other = with("plant.dead_zone_rad=0.1");
    assert!(other.contains("this key belongs to model = \"smooth\""), "{other}");
    let unknown = with("plant.model=four-masses");
    assert!(unknown.contains("\"fmu\" or \"three-masses\""), "{unknown}");
}
