//! The law, its gains and its load loop, sample by sample.

use super::gains::{BrakingCurveSetting, Gains};
use super::law::BrakingCurve;
use super::load_loop::{LoadLoop, LoadLoopState};
use super::tuning::BrakingCurveTuning;
use crate::control::dead_zone_observer::DeadZoneBounds;
use crate::control::load_observer::ObservedLoad;
use crate::control::nominal_model::NominalModel;
use crate::control::torque_knowledge::TorqueKnowledge;
use crate::law::Measurement;

fn setting() -> BrakingCurveSetting<f64> {
    BrakingCurveSetting {
        motor_resolution_rad: 1e-6,
        load_resolution_rad: 1e-6,
        torque_limit_nm: 20.0,
        motor_speed_limit_rad_s: 1000.0,
        period_s: 1e-3,
    }
}

const EXACT: TorqueKnowledge<f64> = TorqueKnowledge {
    torque_offset_nm: 0.0,
    torque_offset_deviation: 0.0,
    torque_ripple_deviation: 0.0,
    cogging_nm: 0.0,
    cogging_per_turn: 12.0,
    cogging_phase_rad: 0.0,
    torque_speed_deviation: 0.0,
};

fn gains(model: &NominalModel<f64>, setting: &BrakingCurveSetting<f64>) -> Gains<f64> {
    Gains::new(model, &BrakingCurveTuning::default(), setting)
}

fn law(torque: &TorqueKnowledge<f64>) -> BrakingCurve<f64> {
    let (tuning, bounds) = (BrakingCurveTuning::default(), DeadZoneBounds::default());
    BrakingCurve::new(&NominalModel::default(), &tuning, torque, &bounds, &setting()).expect("valid")
}

fn load_loop(torque_limit_nm: f64) -> LoadLoop<f64> {
    let model = NominalModel::default();
    let gains = gains(&model, &BrakingCurveSetting { torque_limit_nm, ..setting() });
    LoadLoop::new(&model, &gains, BrakingCurveTuning::<f64>::default().load_coulomb_nm, 1e-3)
}

fn load_at(velocity_rad_s: f64, disturbance_nm: f64) -> ObservedLoad<f64> {
    ObservedLoad { velocity_rad_s, disturbance_nm, transmitted_nm: 0.0, position_error_rad: 0.0 }
}

/// The commanded torque after `samples` of a load at rest at this position, against this lasting load.
fn at_rest(
    load_loop: &LoadLoop<f64>,
    state: &mut LoadLoopState<f64>,
    load_position_rad: f64,
    disturbance_nm: f64,
    samples: u32,
) -> f64 {
    let m = Measurement { load_position_rad, ..Measurement::default() };
    let load = load_at(0.0, disturbance_nm);
    (0..samples).map(|_| load_loop.step(state, &m, &load, 0.0).torque_nm).last().expect("at least one sample")
}

#[test]
fn command_uses_at_most_95_percent_of_the_drive_s_torque() {
    for (torque_limit_nm, want_nm) in [(20.0, 19.0), (10.0, 9.5), (2.0, 1.9)] {
        let have_nm = at_rest(&load_loop(torque_limit_nm), &mut LoadLoop::initial_state(), -2.0, 0.0, 500);
        assert_eq!(have_nm, want_nm, "limit of {torque_limit_nm} N m");
    }
}

#[test]
fn arrival_unloads_the_integral_once_and_departure_releases_the_hold() {
    let (load_loop, mut state) = (load_loop(20.0), LoadLoop::initial_state());
    // 10 mrad short of the target, at standstill, the integral grows beyond its limit at the load.
    let approaching_nm = at_rest(&load_loop, &mut state, -0.01, 0.0, 3000);
    assert!(approaching_nm > 2.4 && !state.holding, "{approaching_nm} N m");
    let before_nm = at_rest(&load_loop, &mut state, -0.0019, 0.0, 1);
    assert!(state.holding);
    let held_nm = at_rest(&load_loop, &mut state, -0.0019, 0.0, 5000);
    assert_eq!(before_nm, held_nm, "the integral is frozen");
    assert!(held_nm < 0.35 * approaching_nm, "{held_nm} N m after {approaching_nm} N m");
    at_rest(&load_loop, &mut state, -0.0039, 0.0, 1);
    assert!(state.holding, "within two bands");
    at_rest(&load_loop, &mut state, -0.0041, 0.0, 1);
    assert!(!state.holding, "beyond two bands");
}

#[test]
fn lasting_load_beyond_stiction_is_not_unloaded() {
    let (load_loop, mut state) = (load_loop(20.0), LoadLoop::initial_state());
    // An integral that needs the growth of its limit, of which 0.3 would be less than the load needs.
    at_rest(&load_loop, &mut state, -0.01, 12.0, 3000);
    let held_nm = at_rest(&load_loop, &mut state, 0.0, 12.0, 1);
    // 12 N m at the load, less at most the stiction of 1.4 * 3.4 N m that may help.
    assert!(3.0 * held_nm > 12.0 - 1.4 * 3.4, "{held_nm} N m at the motor");
}

#[test]
fn integral_s_limit_grows_at_standstill_only() {
    let (load_loop, m) =
        (load_loop(20.0), Measurement { load_position_rad: -0.01, ..Measurement::default() });
    for (velocity_rad_s, grows) in [(0.0, true), (-0.05, false)] {
        let load = load_at(velocity_rad_s, 0.0);
        let mut state = LoadLoop::initial_state();
        // After 3 s the integral has reached its limit.
        let [early_nm, late_nm] = [3000, 2000].map(|samples| {
            let command = (0..samples).map(|_| load_loop.step(&mut state, &m, &load, 0.0)).last();
            command.expect("samples").torque_nm
        });
        let what = std::format!("{velocity_rad_s} rad/s: from {early_nm} to {late_nm} N m");
        assert_eq!(late_nm > early_nm + 1.5, grows, "{what}");
        assert!(grows || late_nm == early_nm, "{what}");
    }
}

#[test]
fn torque_that_the_motor_does_not_give_winds_no_integral() {
    let load_loop = load_loop(20.0);
    let m = Measurement { load_position_rad: -0.01, ..Measurement::default() };
    let after = |missing_nm: f64| {
        let mut state = LoadLoop::initial_state();
        (0..300).map(|_| load_loop.step(&mut state, &m, &load_at(0.0, 0.0), missing_nm)).last()
    };
    let (free, missing) = (after(0.0).expect("samples"), after(1.0).expect("samples"));
    assert!(missing.torque_nm < 0.6 * free.torque_nm, "{missing:?}, {free:?}");
    assert_eq!(after(-1.0), Some(free), "a torque that is missing in the other direction doesn't stop it");
}

/// A machine of other size: torques, lengths and times by these factors.
fn resized(torque: f64, time: f64) -> (NominalModel<f64>, BrakingCurveTuning<f64>, BrakingCurveSetting<f64>) {
    let (model, tuning) = (NominalModel::<f64>::default(), BrakingCurveTuning::<f64>::default());
    let (inertia, friction) = (torque * time * time, torque * time);
    (
        NominalModel {
            motor_inertia_kg_m2: inertia * model.motor_inertia_kg_m2,
            load_inertia_kg_m2: inertia * model.load_inertia_kg_m2,
            motor_friction_nm_s_rad: friction * model.motor_friction_nm_s_rad,
            load_friction_nm_s_rad: friction * model.load_friction_nm_s_rad,
            motor_coulomb_nm: torque * model.motor_coulomb_nm,
            stiffness_nm_rad: torque * model.stiffness_nm_rad,
            ..model
        },
        BrakingCurveTuning {
            load_coulomb_nm: torque * tuning.load_coulomb_nm,
            torque_lag_s: time * tuning.torque_lag_s,
            top_speed_rad_s: tuning.top_speed_rad_s / time,
            ..tuning
        },
        BrakingCurveSetting {
            torque_limit_nm: torque * 20.0,
            motor_speed_limit_rad_s: 1000.0 / time,
            period_s: 1e-3 * time,
            ..setting()
        },
    )
}

#[test]
fn gains_follow_the_machine_s_torques_and_times() {
    let reference = gains(&NominalModel::default(), &setting());
    for (torque, time) in [(0.01, 1.0), (50.0, 1.0), (1.0, 0.1), (0.003, 0.2)] {
        let (model, tuning, setting) = resized(torque, time);
        let have = Gains::new(&model, &tuning, &setting);
        let same = |have: f64, want: f64, what: &str| {
            assert!((have / want - 1.0).abs() < 1e-9, "{torque}, {time}: {what} is {have}, not {want}");
        };
        same(have.braking_rad_s2, reference.braking_rad_s2 / time / time, "deceleration");
        same(have.rate_1_s, reference.rate_1_s / time, "rate");
        same(have.landing_rad, reference.landing_rad, "landing");
        same(have.top_speed_rad_s, reference.top_speed_rad_s / time, "top speed");
        same(have.lead_s, reference.lead_s * time, "lead");
        same(have.speed_nm_s_rad, reference.speed_nm_s_rad * torque * time, "speed gain");
        same(have.integral_nm_rad, reference.integral_nm_rad * torque, "integral gain");
        same(have.integral_limit_nm, reference.integral_limit_nm * torque, "integral limit");
        same(have.reach_nm_s, reference.reach_nm_s * torque / time, "reach");
        same(have.winding_rad_s, reference.winding_rad_s / time, "winding");
        same(have.shaft_nm_rad, reference.shaft_nm_rad * torque, "shaft gain");
        same(have.shaft_nm_s_rad, reference.shaft_nm_s_rad * torque * time, "shaft damping");
        same(have.speed_observer_rad_s, reference.speed_observer_rad_s / time, "observer");
        same(have.friction_turn_rad_s, reference.friction_turn_rad_s / time, "friction");
    }
}

#[test]
fn resolution_delay_and_inertia_of_the_load_slow_the_loops_that_they_limit() {
    let model = NominalModel::<f64>::default();
    let nominal = gains(&model, &setting());
    let coarse = gains(&model, &BrakingCurveSetting { load_resolution_rad: 0.02, ..setting() });
    assert!(coarse.speed_observer_rad_s < 0.7 * nominal.speed_observer_rad_s, "{coarse:?}");
    let stiff = NominalModel { stiffness_nm_rad: 100.0, ..model };
    let stiff = gains(&stiff, &setting());
    // 0.2 / 2.5 ms for the winding, and 0.1 / 2.5 ms for the motor's loop: 1.6 N m/rad at 0.000972 kg m^2.
    assert!((stiff.winding_rad_s - 80.0).abs() < 1e-6, "{} rad/s", stiff.winding_rad_s);
    assert!((stiff.shaft_nm_rad - 1.5552).abs() < 1e-4, "{} N m/rad", stiff.shaft_nm_rad);
    let light = NominalModel { load_inertia_kg_m2: 0.4, load_friction_nm_s_rad: 0.8, ..model };
    assert!((gains(&light, &setting()).winding_rad_s / nominal.winding_rad_s - 1.6).abs() < 1e-9);
}

#[test]
fn drive_without_torque_has_finite_gains() {
    let mut idle = BrakingCurve::new(
        &NominalModel::default(),
        &BrakingCurveTuning::default(),
        &TorqueKnowledge::default(),
        &DeadZoneBounds::default(),
        &BrakingCurveSetting { torque_limit_nm: 0.0, ..setting() },
    )
    .expect("valid");
    for _ in 0..100 {
        let output = idle.step(&Measurement { load_position_rad: 1.0, ..Measurement::default() });
        assert!(output.torque_nm.is_finite() && output.signals.dead_zone_deviation_rad.is_finite());
    }
}

/// The law's estimate and deviation after torques of this amplitude at a spring with half a gap of 0.1 rad.
fn learnt_at(amplitude_nm: f64) -> (f64, f64) {
    let mut law = law(&EXACT);
    let mut signals = None;
    for k in 0..40_000 {
        let torque = amplitude_nm * (f64::from(k) * 5e-4).sin();
        let twist_rad = torque + 0.1 * torque.signum();
        let wound = Measurement {
            applied_torque_nm: torque,
            twist_rad,
            motor_position_rad: twist_rad,
            motor_velocity_rad_s: amplitude_nm * 0.5 * (f64::from(k) * 5e-4).cos(),
            load_position_rad: -0.5,
            ..Measurement::default()
        };
        signals = Some(law.step(&wound).signals);
    }
    let signals = signals.expect("stepped");
    (signals.dead_zone_estimate_rad, signals.dead_zone_deviation_rad)
}

#[test]
fn gap_is_learnt_only_from_torque_enough() {
    let (estimate_rad, deviation_rad) = learnt_at(3.0);
    assert!((estimate_rad - 0.1).abs() < 5e-3, "{estimate_rad} rad");
    assert!(deviation_rad < 0.015, "{deviation_rad} rad");
    // 0.012 of 20 N m is the least torque at which contact is certain.
    let (estimate_rad, deviation_rad) = learnt_at(0.23);
    assert!((estimate_rad - 0.16).abs() < 1e-12, "the prior value: {estimate_rad} rad");
    assert!((deviation_rad - 1.9 * 0.16).abs() < 1e-3, "and nothing learnt: {deviation_rad} rad");
}

#[test]
fn accelerating_or_resting_motor_does_not_teach_the_gap() {
    let prior_rad = law(&EXACT).step(&Measurement::default()).signals.dead_zone_deviation_rad;
    let mut law_of_fast = law(&EXACT);
    let mut law_at_rest = law(&EXACT);
    for k in 0..40_000 {
        // The torque alternates faster than the observer follows: the motor is never balanced for 19 periods.
        let torque = if k % 20 < 10 { 6.0 } else { 1.0 };
        let fast = Measurement {
            applied_torque_nm: torque,
            twist_rad: 3.5,
            motor_position_rad: 1e-3 * f64::from(k),
            motor_velocity_rad_s: 1.0,
            load_position_rad: -0.5,
            ..Measurement::default()
        };
        assert_eq!(law_of_fast.step(&fast).signals.dead_zone_deviation_rad, prior_rad, "sample {k}");
        // The direction of the friction of a motor at rest is unknown.
        let rest = Measurement { motor_position_rad: 2.0, motor_velocity_rad_s: 0.0, ..fast };
        let rest = Measurement { applied_torque_nm: 3.0, ..rest };
        assert_eq!(law_at_rest.step(&rest).signals.dead_zone_deviation_rad, prior_rad, "sample {k}");
    }
}

#[test]
fn known_offset_and_cogging_are_compensated() {
    let known = TorqueKnowledge { torque_offset_nm: 0.2, cogging_nm: 0.1, ..EXACT };
    let m = Measurement { motor_position_rad: 0.1, twist_rad: 0.1, ..Measurement::default() };
    let have_nm = law(&known).step(&m).torque_nm - law(&EXACT).step(&m).torque_nm;
    // 0.1 sin(12 * 0.1)
    assert!((have_nm + 0.2 + 0.1 * 1.2_f64.sin()).abs() < 2e-4, "{have_nm} N m");
}
