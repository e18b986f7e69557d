//! What a real motor and a real load add to the backlash shaft, against closed forms.

use std::f64::consts::TAU;

use lashloop_plant::backlash_shaft::{
    BacklashShaft, CoggingParameters, LoadModeParameters, ShaftParameters, StribeckParameters,
};
use lashloop_plant::{Environment, Mechanics, Plant, RunningPlant, Start};

const NO_FRICTION: StribeckParameters =
    StribeckParameters { coulomb_nm: 0.0, stiction_nm: 0.0, velocity_rad_s: 1.0 };

const MOTOR_INERTIA_KG_M2: f64 = 9.72e-4;
const LOAD_INERTIA_KG_M2: f64 = 7.5;

/// An ideal drive without friction.
fn ideal() -> ShaftParameters {
    ShaftParameters { load: NO_FRICTION, motor: NO_FRICTION, current_lag_s: 0.0, ..ShaftParameters::paper() }
}

/// Motor and load in the middle of a gap too wide to cross.
fn apart(parameters: ShaftParameters, motor_position_rad: f64) -> RunningPlant<BacklashShaft> {
    let mechanics = Mechanics {
        motor_friction_nm_s_rad: 0.0,
        load_friction_nm_s_rad: 0.0,
        dead_zone_rad: 10.0,
        ..Mechanics::paper()
    };
    let plant = BacklashShaft::new(mechanics, parameters, 16).expect("valid plant");
    RunningPlant::released(plant, Start::at_rest(0.0, motor_position_rad))
}

fn run(plant: &mut RunningPlant<BacklashShaft>, torque_nm: f64, steps: u32) {
    for _ in 0..steps {
        plant.step(torque_nm, 1e-3).expect("the plant steps");
    }
}

#[track_caller]
fn assert_close(what: &str, have: f64, want: f64, tolerance: f64) {
    assert!((have - want).abs() <= tolerance, "{what}: have {have}, want {want} +- {tolerance}");
}

#[test]
fn an_offset_adds_to_the_command_and_saturates_with_it() {
    for (torque_nm, want_nm) in [(0.0, 0.3), (-0.3, 0.0), (0.9, 1.0), (-9.0, -1.0)] {
        let mut plant =
            apart(ShaftParameters { torque_offset_nm: 0.3, torque_saturation_nm: 1.0, ..ideal() }, 0.0);
        run(&mut plant, torque_nm, 10);
        let truth = plant.truth();
        assert_close("torque, N m", truth.motor_torque_nm, want_nm, 1e-15);
        assert_close("speed, rad/s", truth.motor_velocity_rad_s, want_nm / MOTOR_INERTIA_KG_M2 * 0.01, 1e-9);
    }
}

#[test]
fn a_motor_swings_in_its_cogging_and_keeps_its_energy() {
    let cogging = CoggingParameters { amplitude_nm: 0.1, per_turn: 12.0 };
    // sin(n theta) has its stable zero at n theta = pi.
    let (rest_rad, swing_rad) = (TAU / 24.0, 1e-4);
    let mut plant = apart(ShaftParameters { cogging, ..ideal() }, rest_rad + swing_rad);
    let period_s = TAU / (12.0 * 0.1 / MOTOR_INERTIA_KG_M2).sqrt();
    let before_j = plant.truth().energy_j();
    run(&mut plant, 0.0, 1000);
    let truth = plant.truth();
    let want_rad = rest_rad + swing_rad * (TAU / period_s).cos();
    assert_close("motor, rad", truth.motor_position_rad, want_rad, 1e-7);
    assert_close("energy, J", truth.energy_j(), before_j, 1e-12);
    assert_eq!((truth.supplied_energy_j, truth.dissipated_energy_j), (0.0, 0.0));
}

#[test]
fn a_load_of_two_masses_swings_about_its_centre_of_mass() {
    let load_mode = LoadModeParameters { fraction: 0.8, frequency_hz: 6.0, damping_ratio: 0.0 };
    let mut plant = apart(ShaftParameters { load_mode, ..ideal() }, 0.0);
    let (torque_nm, time_s) = (2.0, 0.1);
    plant
        .set_environment(Environment { load_torque_nm: torque_nm, gap_growth_rad: 0.0 })
        .expect("a load torque");
    run(&mut plant, 0.0, 100);
    let rate = TAU * load_mode.frequency_hz;
    let inner_kg_m2 = LOAD_INERTIA_KG_M2 * (1.0 - load_mode.fraction);
    let centre_rad = 0.5 * torque_nm / LOAD_INERTIA_KG_M2 * time_s * time_s;
    let twist_rad = -torque_nm / (inner_kg_m2 * rate * rate) * (1.0 - (rate * time_s).cos());
    let truth = plant.truth();
    assert_close("inner, rad", truth.load_position_rad, centre_rad - load_mode.fraction * twist_rad, 1e-9);
    let outer_rad = centre_rad + (1.0 - load_mode.fraction) * twist_rad;
    assert_close("outer, rad", plant.judged_load_position_rad(), outer_rad, 1e-9);
    assert_eq!(plant.positions().load_position_rad, truth.load_position_rad, "the encoder is at the gear");
    assert_close("energy, J", truth.energy_j(), truth.supplied_energy_j, 1e-9);
}

#[test]
fn a_stiff_load_mode_is_a_rigid_load() {
    let judged = |fraction| {
        let load_mode = LoadModeParameters { fraction, frequency_hz: 1000.0, damping_ratio: 0.5 };
        let parameters = ShaftParameters { load_mode, ..ShaftParameters::paper() };
        let plant = BacklashShaft::new(Mechanics::paper(), parameters, 16).expect("valid plant");
        let mut plant = RunningPlant::released(plant, Start::at_rest(0.0, 0.0));
        run(&mut plant, 5.0, 500);
        plant.judged_load_position_rad()
    };
    assert!(judged(0.0) > 0.1, "the load moves: {} rad", judged(0.0));
    assert_close("load, rad", judged(0.5), judged(0.0), 1e-4);
}

#[test]
fn an_asymmetric_motor_breaks_away_at_another_torque_each_way() {
    let moves = |torque_nm: f64| {
        let mut plant = apart(ShaftParameters { motor_asymmetry: 0.2, ..ShaftParameters::paper() }, 0.0);
        run(&mut plant, torque_nm, 100);
        plant.truth().motor_velocity_rad_s != 0.0
    };
    // Stiction 0.025 N m, 20 % more forwards.
    assert_eq!([0.0299, 0.0301, -0.0199, -0.0201].map(moves), [false, true, false, true]);
}
