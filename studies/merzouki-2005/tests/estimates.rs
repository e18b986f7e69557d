//! What moves the estimates of the gap on the plant with friction, in mrad at the end of the run.

use lashloop::{Bench, run};
use lashloop_bench::scenario::{Override, Scenario};
use merzouki_2005::scenarios::SCENARIOS;

/// Ends of estimate and deviation; no deviation under a law that reports none.
fn ends_mrad(law: &str, settings: &[&str]) -> [Option<f64>; 2] {
    let set = |setting: &&str| Override::Set((*setting).to_owned());
    let controller = Override::Controller(law.to_owned());
    let overrides: Vec<_> =
        [controller, set(&"expect=[]")].into_iter().chain(settings.iter().map(set)).collect();
    let (name, text) = SCENARIOS[3];
    let scenario = Scenario::from_str(name, text, &overrides).expect("a scenario");
    let outcome = run(&scenario, &Bench::new().device("inproc").expect("a device")).expect("a run");
    ["drive.dead_zone_estimate_rad", "drive.dead_zone_deviation_rad"].map(|signal| {
        let end_rad = outcome.columns().get(signal).and_then(|values| values.last());
        end_rad.map(|end_rad| (1e3 * end_rad).round())
    })
}

#[test]
fn without_friction_the_paper_s_estimate_returns_towards_the_gap() {
    assert_eq!(ends_mrad("merzouki", &[]), [Some(303.0), None]);
    assert_eq!(ends_mrad("merzouki", &["plant.load_coulomb_nm=0"]), [Some(179.0), None]);
}

#[test]
fn the_estimate_of_braking_curve_is_right_from_another_start_too() {
    let start = "controller.parameters.dead_zone_initial_rad=0.3";
    let exact = ["torque_offset_deviation", "torque_ripple_deviation"]
        .map(|name| format!("controller.parameters.{name}=0"));
    let [offset, ripple] = exact.each_ref().map(String::as_str);
    for (settings, estimate_mrad, deviation_mrad) in [
        (&[][..], 160.0, 142.0),
        (&[offset, ripple], 160.0, 15.0),
        (&[start], 169.0, 148.0),
        (&[start, offset, ripple], 160.0, 15.0),
    ] {
        let ends_mrad = ends_mrad("braking-curve", settings);
        assert_eq!(ends_mrad, [Some(estimate_mrad), Some(deviation_mrad)], "{settings:?}");
    }
}
