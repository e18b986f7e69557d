//! Single events of the backlash shaft against their closed forms. A substep is a millisecond here, so an instant within
//! it is correct only if it was located.

use lashloop_plant::backlash_shaft::{BacklashShaft, ShaftParameters, StribeckParameters};
use lashloop_plant::{Contact, DryFriction, Environment, Mechanics, PlantError, RunningPlant, Start, Truth};

const NO_FRICTION: StribeckParameters =
    StribeckParameters { coulomb_nm: 0.0, stiction_nm: 0.0, velocity_rad_s: 1.0 };

/// An ideal drive without friction or damping.
fn parameters() -> ShaftParameters {
    ShaftParameters {
        shaft_damping_nm_s_rad: 0.0,
        load: NO_FRICTION,
        motor: NO_FRICTION,
        current_lag_s: 0.0,
        torque_saturation_nm: 1e3,
        ..ShaftParameters::paper()
    }
}

/// A load too heavy to move.
fn mechanics() -> Mechanics {
    Mechanics { motor_friction_nm_s_rad: 0.0, load_inertia_kg_m2: 1e6, ..Mechanics::paper() }
}

const INERTIA: f64 = 9.72e-4;
const HALF_GAP: f64 = 0.16;

fn motor_at(position_rad: f64, velocity_rad_s: f64) -> Start {
    Start { motor_velocity_rad_s: velocity_rad_s, ..Start::at_rest(0.0, position_rad) }
}

fn released(
    mechanics: Mechanics,
    parameters: ShaftParameters,
    substeps: u32,
    start: Start,
) -> RunningPlant<BacklashShaft> {
    let plant = BacklashShaft::new(mechanics, parameters, substeps).expect("valid plant");
    RunningPlant::released(plant, start)
}

/// The paper's plant at 16 substeps.
fn paper(start: Start) -> RunningPlant<BacklashShaft> {
    released(Mechanics::paper(), ShaftParameters::paper(), 16, start)
}

/// The truth after each of `steps` milliseconds under a constant torque.
fn run(parameters: ShaftParameters, start: Start, torque_nm: f64, steps: usize) -> Vec<Truth> {
    let mut plant = released(mechanics(), parameters, 1, start);
    let mut step = || {
        plant.step(torque_nm, 1e-3).expect("the plant steps");
        plant.truth()
    };
    (0..steps).map(|_| step()).collect()
}

#[track_caller]
fn assert_close(what: &str, have: f64, want: f64, tolerance: f64) {
    assert!((have - want).abs() <= tolerance, "{what}: have {have}, want {want} +- {tolerance}");
}

#[test]
fn motor_reaches_the_flank_at_the_end_of_its_free_flight() {
    // theta_e = t^2 U / 2 J reaches j0 at t = sqrt(2 J j0 / U) and continues as an oscillator around j0 + U / K.
    let torque_nm = 1.0;
    let touch_s = (2.0 * INERTIA * HALF_GAP / torque_nm).sqrt();
    let truths = run(parameters(), motor_at(0.0, 0.0), torque_nm, 30);
    let omega = (1.0 / INERTIA).sqrt();
    for (k, truth) in (1..).zip(truths) {
        let since_s = f64::from(k) * 1e-3 - touch_s;
        let (contact, position) = if since_s < 0.0 {
            (Contact::Gap, 0.5 * torque_nm / INERTIA * (f64::from(k) * 1e-3).powi(2))
        } else {
            let turn = omega * since_s;
            let speed = torque_nm / INERTIA * touch_s;
            let stretch = torque_nm * (1.0 - turn.cos()) + speed / omega * turn.sin();
            (Contact::Positive, HALF_GAP + stretch)
        };
        assert_eq!(truth.contact, contact, "after {k} ms");
        // One substep of 1 ms at 32 rad/s leaves 1e-9 of the amplitude.
        assert_close("motor, rad", truth.motor_position_rad, position, 1e-6);
    }
}

#[test]
fn contact_opens_when_it_would_pull_and_the_shaft_relaxes() {
    // From rest at a twist A: y = A e^(-a t) (cos b t + a/b sin b t) until C = -J dd(y) is zero, at tan(b t) = b/a. Then
    // the motor moves freely and the shaft relaxes with K / c.
    let (damping, stretch) = (0.02, 0.5);
    let (a, b) = {
        let a = damping / (2.0 * INERTIA);
        (a, (1.0 / INERTIA - a * a).sqrt())
    };
    let leave_s = (b / a).atan() / b;
    let speed = -stretch / (INERTIA * b) * (-a * leave_s).exp() * (b * leave_s).sin();
    let left = stretch * (-a * leave_s).exp() * ((b * leave_s).cos() + a / b * (b * leave_s).sin());
    let parameters = ShaftParameters { shaft_damping_nm_s_rad: damping, ..parameters() };
    // Long enough to open, too short to reach the other flank.
    let steps = (leave_s * 1e3) as usize + 12;
    let truths = run(parameters, motor_at(HALF_GAP + stretch, 0.0), 0.0, steps);
    for (k, truth) in (1..).zip(truths) {
        let since_s = f64::from(k) * 1e-3 - leave_s;
        if since_s < 0.0 {
            assert_eq!(truth.contact, Contact::Positive, "after {k} ms");
            continue;
        }
        assert_eq!(truth.contact, Contact::Gap, "after {k} ms");
        assert_close("motor, rad/s", truth.motor_velocity_rad_s, speed, 1e-4);
        let twist = HALF_GAP + left + speed * since_s;
        assert_close("twist, rad", truth.twist_rad, twist, 1e-5);
        let gap = twist - left * (-since_s / damping).exp();
        assert_close("position in the gap, rad", truth.gap_position_rad, gap, 1e-5);
    }
}

#[test]
fn mass_stops_where_coulomb_friction_stops_it_and_sticks() {
    // v^2 J / 2 F_c after v J / F_c, in the middle of a step.
    let friction = StribeckParameters { coulomb_nm: 0.05, stiction_nm: 0.05, velocity_rad_s: 1.0 };
    let (velocity, parameters) = (0.55, ShaftParameters { motor: friction, ..parameters() });
    let truths = run(parameters, motor_at(0.0, velocity), 0.0, 40);
    let stop_s = velocity * INERTIA / 0.05;
    let want = velocity * velocity * INERTIA / (2.0 * 0.05);
    for (k, truth) in (1..).zip(&truths) {
        let sticks = f64::from(k) * 1e-3 > stop_s;
        assert_eq!(truth.motor_friction == DryFriction::Stick, sticks, "after {k} ms");
        assert_eq!(truth.motor_velocity_rad_s == 0.0, sticks, "after {k} ms");
    }
    assert_close("motor, rad", truths[39].motor_position_rad, want, 1e-12);
    // Friction dissipates the whole kinetic energy.
    let kinetic_j = 0.5 * INERTIA * velocity * velocity;
    assert_close("dissipated, J", truths[39].dissipated_energy_j, kinetic_j, 1e-14);
}

#[test]
fn mass_breaks_away_when_lagging_torque_reaches_stiction() {
    // tau = U (1 - e^(-t / T)) reaches F_s at t = -T ln(1 - F_s / U).
    let (stiction, torque_nm, lag_s) = (0.3, 0.4, 5e-3);
    let friction = StribeckParameters { coulomb_nm: stiction, stiction_nm: stiction, velocity_rad_s: 1.0 };
    let lagging = ShaftParameters { motor: friction, current_lag_s: lag_s, ..parameters() };
    let break_s = -lag_s * (1.0 - stiction / torque_nm).ln();
    for (k, truth) in (1..).zip(run(lagging, motor_at(0.0, 0.0), torque_nm, 12)) {
        let time_s = f64::from(k) * 1e-3;
        assert_close(
            "torque, N m",
            truth.motor_torque_nm,
            torque_nm * (1.0 - (-time_s / lag_s).exp()),
            1e-14,
        );
        assert_eq!(truth.motor_friction == DryFriction::Stick, time_s < break_s, "after {k} ms");
        let moving_s = (time_s - break_s).max(0.0);
        let momentum = (torque_nm - stiction) * moving_s
            - torque_nm * lag_s * ((-break_s / lag_s).exp() - (-(break_s + moving_s) / lag_s).exp());
        assert_close("motor, rad/s", truth.motor_velocity_rad_s, momentum / INERTIA, 1e-5);
    }
}

#[test]
fn friction_falls_from_stiction_to_coulomb_as_speed_grows() {
    let friction = StribeckParameters { coulomb_nm: 0.1, stiction_nm: 0.2, velocity_rad_s: 2.0 };
    for velocity in [1e-9, 0.5, -2.0, 4.0, -30.0] {
        let parameters = ShaftParameters { motor: friction, ..parameters() };
        let truth = released(mechanics(), parameters, 1, motor_at(0.0, velocity)).truth();
        let want = (0.1 + 0.1 * (-velocity * velocity / 4.0_f64).exp()) * velocity.signum();
        assert_close("friction, N m", truth.motor_dry_friction_nm, want, 1e-15);
    }
}

#[test]
fn asymmetric_friction_holds_more_in_its_stronger_direction() {
    let load = StribeckParameters { coulomb_nm: 3.0, stiction_nm: 4.0, velocity_rad_s: 0.03 };
    let asymmetric = ShaftParameters { load, load_asymmetry: 0.25, ..parameters() };
    for (load_torque_nm, sticks) in [(4.99, true), (5.01, false), (-2.99, true), (-3.01, false)] {
        let mut plant = released(Mechanics::paper(), asymmetric, 4, Start::at_rest(0.0, 0.0));
        let environment = Environment { gap_growth_rad: 0.0, load_torque_nm };
        plant.set_environment(environment).expect("in range");
        plant.step(0.0, 1e-3).expect("the plant steps");
        assert_eq!(plant.truth().load_friction == DryFriction::Stick, sticks, "{load_torque_nm} N m");
    }
}

#[test]
fn torque_saturates_at_its_limit() {
    let weak = ShaftParameters { torque_saturation_nm: 2.0, ..parameters() };
    for (command_nm, want_nm) in [(1.5, 1.5), (30.0, 2.0), (-30.0, -2.0)] {
        let truth = run(weak, motor_at(0.0, 0.0), command_nm, 1)[0];
        assert_eq!(truth.motor_torque_nm, want_nm);
    }
}

#[test]
fn masses_pressed_together_at_rest_do_not_move() {
    let mut plant = paper(Start::at_rest(0.0, 0.0));
    let mut hold = |steps| {
        for _ in 0..steps {
            plant.step(1.0, 1e-3).expect("no chatter");
        }
        plant.truth()
    };
    // The torque closes the gap and stays below the stiction of the load.
    let truth = hold(3_000);
    assert_eq!((truth.contact, truth.load_friction, truth.motor_friction), {
        (Contact::Positive, DryFriction::Stick, DryFriction::Stick)
    });
    assert_eq!(hold(1_000), truth);
}

#[test]
fn gap_that_widens_lets_the_shaft_unwind() {
    let mut plant = paper(Start::at_rest(0.0, HALF_GAP + 0.5));
    let before = plant.truth();
    let worn = Environment { gap_growth_rad: 0.1, load_torque_nm: 0.0 };
    plant.set_environment(worn).expect("in range");
    let after = plant.truth();
    assert_eq!(after.gap_position_rad, HALF_GAP + 0.1);
    assert_close("C, N m", after.transmitted_torque_nm, 0.4, 1e-15);
    assert_close("J", after.dissipated_energy_j, before.energy_j() - after.energy_j(), 1e-15);
    let unknown = Environment { gap_growth_rad: f64::NAN, load_torque_nm: 0.0 };
    let error = plant.set_environment(unknown).expect_err("NaN").to_string();
    assert_eq!(error, "parameter dead_zone_rad of the simulated plant is NaN, allowed is 0.000001 to 10");
}

#[test]
fn changed_parameters_keep_the_state_and_the_energy_balance() {
    let mut plant = paper(Start::at_rest(0.0, HALF_GAP + 0.5));
    let before = plant.truth();
    let soft = Mechanics { stiffness_nm_rad: 0.6, ..Mechanics::paper() };
    plant.change_parameters(BacklashShaft::new(soft, ShaftParameters::paper(), 16).expect("valid plant"));
    let after = plant.truth();
    assert_eq!(after.motor_position_rad, before.motor_position_rad);
    assert_close("C, N m", after.transmitted_torque_nm, 0.3, 1e-15);
    assert_close("J", after.dissipated_energy_j, before.energy_j() - after.energy_j(), 1e-15);
}

#[test]
fn plant_too_stiff_is_rejected_before_it_moves() {
    let hard = Mechanics { stiffness_nm_rad: 1e9, ..mechanics() };
    let mut plant = released(hard, parameters(), 1, motor_at(0.0, 1.0));
    let before = plant;
    let error = plant.step(0.0, 1e-2).expect_err("too stiff");
    assert!(matches!(error, PlantError::TooStiff { .. }));
    assert!(error.to_string().starts_with("plant is too stiff: a step of 0.01 s would need "), "{error}");
    assert_eq!(plant, before);
    plant.step(0.0, 1e-3).expect("a shorter step is fine");
}

#[test]
fn parameters_out_of_range_are_rejected_by_name() {
    let paper = ShaftParameters::paper();
    let rejected =
        |parameters| BacklashShaft::new(Mechanics::paper(), parameters, 16).expect_err("out of range").name;
    let slippery = StribeckParameters { stiction_nm: 3.0, ..paper.load };
    assert_eq!(rejected(ShaftParameters { load: slippery, ..paper }), "load_stiction_nm");
    let jerky = StribeckParameters { velocity_rad_s: 0.0, ..paper.motor };
    assert_eq!(rejected(ShaftParameters { motor: jerky, ..paper }), "motor_stribeck_rad_s");
    assert_eq!(rejected(ShaftParameters { shaft_damping_nm_s_rad: -1.0, ..paper }), "shaft_damping_nm_s_rad");
    assert_eq!(rejected(ShaftParameters { current_lag_s: f64::INFINITY, ..paper }), "current_lag_s");
}
