//! Faults of the plant.

use super::scenario;
use crate::fault::plant::PlantFaults;

const FROM_2_FOR_3: &str = "at_s = 0.002\nfor_s = 0.003\n";

fn at(step: u32, faults: &[String]) -> (f64, f64, f64, f64) {
    let faults: Vec<_> = faults.iter().map(String::as_str).collect();
    let scenario = scenario(&faults);
    let healthy = &scenario.plant;
    let faults = PlantFaults::new(&scenario);
    let (environment, values) = (faults.environment(step), faults.values(step, healthy));
    let ratio = |key| values.number(key).expect("a number") / healthy.number(key).expect("a number");
    assert_eq!(ratio("load_coulomb_nm"), ratio("load_stiction_nm"));
    (
        environment.gap_growth_rad,
        environment.load_torque_nm,
        ratio("stiffness_nm_rad"),
        ratio("load_coulomb_nm"),
    )
}

fn fault(text: &str) -> String {
    format!("{FROM_2_FOR_3}{text}")
}

#[test]
fn gap_and_load_torque_change_while_their_faults_last() {
    let faults =
        [fault("kind = \"gap-growth\"\ngrowth_rad = 0.1"), fault("kind = \"load-torque\"\ntorque_nm = -5")];
    assert_eq!(at(1, &faults), (0.0, 0.0, 1.0, 1.0));
    assert_eq!(at(2, &faults), (0.1, -5.0, 1.0, 1.0));
    assert_eq!(at(5, &faults), (0.0, 0.0, 1.0, 1.0));
}

#[test]
fn stiffness_and_friction_change_by_a_factor_and_recover() {
    let faults =
        [fault("kind = \"stiffness-drop\"\nfactor = 0.25"), fault("kind = \"friction-change\"\nfactor = 2")];
    assert_eq!(at(1, &faults), (0.0, 0.0, 1.0, 1.0));
    assert_eq!(at(4, &faults), (0.0, 0.0, 0.25, 2.0));
    assert_eq!(at(5, &faults), (0.0, 0.0, 1.0, 1.0));
}

#[test]
fn two_faults_of_a_kind_add_up() {
    let growth = fault("kind = \"gap-growth\"\ngrowth_rad = 0.1");
    let drop = fault("kind = \"stiffness-drop\"\nfactor = 0.5");
    let (growth_rad, _, stiffness, _) = at(3, &[growth.clone(), growth, drop.clone(), drop]);
    assert_eq!((growth_rad, stiffness), (0.2, 0.25));
}

#[test]
fn parameters_change_at_the_edges_of_faults_only() {
    let scenario = scenario(&[
        &fault("kind = \"stiffness-drop\"\nfactor = 0.5"),
        "kind = \"friction-change\"\nfactor = 2\nat_s = 0.5",
        "kind = \"load-torque\"\ntorque_nm = 1\nat_s = 0.7",
    ]);
    let changes = PlantFaults::new(&scenario).changes(&scenario.plant);
    let steps: Vec<_> = changes.into_iter().map(|(step, _)| step).collect();
    assert_eq!(steps, [2, 5, 500]);
}
