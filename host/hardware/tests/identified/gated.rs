//! The gate: a law is judged on the plant that its scenario describes, or not at all.

use std::fs;

use lashloop::{Bench, Outcome, Scenario, run};
use lashloop_hardware::identify::gate::{Departure, Intervals, RecordedMotion, check, intervals};

fn scenario(settings: &[&str]) -> Scenario {
    let all = [settings, &["run.duration_s=3", "expect=[]", r#"meant=["mismatch"]"#]].concat();
    Bench::new().scenario("../../scenarios/shaft-braking-curve.toml", &all).expect("a scenario")
}

fn recorded(settings: &[&str]) -> RecordedMotion {
    let device = Bench::new().device("inproc").expect("a device");
    let outcome: Outcome = run(&scenario(settings), &device).expect("a run");
    RecordedMotion::of(outcome.columns()).expect("torques and positions")
}

/// Settings of other plants.
const OTHER: [&str; 5] = [
    "plant.dead_zone_rad=0.17",
    "plant.load_coulomb_nm=3.2",
    "plant.load_inertia_kg_m2=7.2",
    "plant.motor_inertia_kg_m2=1.02e-3",
    "plant.stiffness_nm_rad=1.03",
];

#[test]
fn a_record_of_the_same_plant_passes_without_any_interval() {
    assert_eq!(check(&scenario(&[]), &recorded(&[]), &Intervals::default()).expect("a plant"), None);
}

#[test]
fn a_record_of_another_plant_gives_no_verdict() {
    for setting in OTHER {
        let departure = check(&scenario(&[]), &recorded(&[setting]), &Intervals::default()).expect("a plant");
        let departure = departure.unwrap_or_else(|| panic!("{setting} passes"));
        assert!(departure.distance_rad > departure.limit_rad, "{setting}: {departure}");
        let sentence = departure.to_string();
        assert!(
            sentence.contains("does not follow the recorded motion") && sentence.contains(" rad"),
            "{sentence}"
        );
    }
}

#[test]
fn a_plant_within_the_intervals_passes_and_one_beyond_them_does_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("estimates.json");
    let text = r#"{ "quantities": [
        { "name": "dead_zone_rad", "estimate": { "value": 0.16, "low": 0.145, "high": 0.175 } },
        { "name": "load_inertia_kg_m2", "estimate": null }
    ] }"#;
    fs::write(&file, text).expect("a file");
    let intervals = intervals(&file).expect("intervals");
    let judged = |setting| check(&scenario(&[]), &recorded(&[setting]), &intervals).expect("a plant");
    assert_eq!(judged("plant.dead_zone_rad=0.17"), None);
    assert!(judged("plant.dead_zone_rad=0.22").is_some());
    assert!(judged("plant.load_inertia_kg_m2=6.5").is_some(), "no interval explains another inertia");
}

/// Bench mode, with a motor that stands elsewhere in the gap than the scenario has it.
const BENCH: [&str; 3] = ["run.mode=bench", "bench.torque_per_duty_nm=62.5", "bench.twist_limit_rad=40"];

fn judged_on_bench(plant: &[&str]) -> Option<Departure> {
    let recorded = recorded(&[&BENCH[..], plant].concat());
    check(&scenario(&BENCH), &recorded, &Intervals::default()).expect("a plant")
}

#[test]
fn on_a_bench_the_same_plant_passes_wherever_the_motor_stands() {
    for by_rad in [-0.15, -0.05, 0.0, 0.12] {
        let motor_rad = 3.0 * std::f64::consts::FRAC_PI_2 + by_rad;
        let start = format!("plant.initial.motor_position_rad={motor_rad}");
        assert_eq!(judged_on_bench(&[&start]), None, "turned by {by_rad} rad");
    }
}

#[test]
fn on_a_bench_each_wrong_parameter_gives_no_verdict() {
    for setting in OTHER {
        assert!(judged_on_bench(&[setting]).is_some(), "{setting} passes");
    }
}
