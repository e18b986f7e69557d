//! Estimates from records of closed loops.

use lashloop::{Bench, run};
use lashloop_bench::scenario::RunMode;
use lashloop_hardware::identify::record::series;
use lashloop_identify::{Direction, Identified, Instruments, Start, identify};

use crate::commissioned::assert_shown;

/// Runs a scenario in process and estimates its plant from the counts.
fn identified(scenario: &str, settings: &[&str]) -> Identified {
    let bench = Bench::new();
    let all = [settings, &["run.duration_s=6", "expect=[]", r#"meant=["mismatch"]"#]].concat();
    let scenario = bench.scenario(format!("../../scenarios/{scenario}.toml"), &all).expect("a scenario");
    let outcome = run(&scenario, &bench.device("inproc").expect("a device")).expect("a run");
    let instruments = Instruments::exact(4000, 4000, 1000);
    let series =
        series(outcome.columns(), &instruments, RunMode::Hil, [Direction::Forward; 2]).expect("a series");
    identify(&[series], &instruments, &Start::default()).expect("a motion")
}

const OTHER_PLANT: [&str; 4] = [
    "plant.motor_inertia_kg_m2=1.2e-3",
    "plant.stiffness_nm_rad=1.25",
    "plant.dead_zone_rad=0.2",
    "plant.load_coulomb_nm=3.0",
];

#[test]
fn a_move_in_one_direction_shows_the_friction_of_that_direction_only() {
    let identified = identified("shaft-braking-curve", &OTHER_PLANT);
    assert!(identified.is_followed(), "{:?}", identified.residual_counts);
    for (name, truth) in [
        ("motor_inertia_kg_m2", 1.2e-3),
        ("stiffness_nm_rad", 1.25),
        ("gap_width_rad", 0.4),
        ("reduction_ratio", 3.0),
        ("load_inertia_kg_m2", 7.5),
    ] {
        assert_shown(&identified, name, truth, 0.02);
    }
    // In one direction an offset of the torque looks like friction.
    assert_shown(&identified, "load_coulomb_backward_nm", 3.0, 0.15);
    let width = |name| {
        let estimate = identified.quantity(name).and_then(|it| it.estimate);
        estimate.map_or(f64::INFINITY, |it| it.high / it.low - 1.0)
    };
    assert!(width("load_coulomb_forward_nm") > 20.0 * width("load_coulomb_backward_nm"));
}

#[test]
fn a_sine_on_one_flank_does_not_show_the_gap() {
    let identified = identified("shaft-pd-sine", &OTHER_PLANT);
    assert!(identified.is_followed(), "{:?}", identified.residual_counts);
    assert_eq!(identified.quantity("gap_width_rad").and_then(|it| it.estimate), None);
    assert_shown(&identified, "stiffness_nm_rad", 1.25, 0.02);
}
