//! For all parameters and torques a plant returns finite numbers or an error, never a panic or NaN.

use lashloop_plant::backlash_shaft::{
    BacklashShaft, BristleParameters, CoggingParameters, LoadModeParameters, ShaftParameters,
    StribeckParameters,
};
use lashloop_plant::hard_coulomb::HardCoulomb;
use lashloop_plant::smooth::Smooth;
use lashloop_plant::{Environment, Mechanics, PlantError, RunningPlant, Start, Truth, TwoMass};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Magnitudes between the bounds, uniform in their logarithm; sometimes a bound.
fn size(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (low.ln()..=high.ln()).prop_map(move |exponent| exponent.exp().clamp(low, high)),
        1 => Just(low),
        1 => Just(high),
    ]
}

/// As [`size`], or zero.
fn size_or_zero(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![4 => size(low, high), 1 => Just(0.0)]
}

fn signed(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (size_or_zero(low, high), any::<bool>()).prop_map(|(size, negative)| if negative { -size } else { size })
}

prop_compose! {
    fn mechanics()(
        motor_inertia_kg_m2 in size(1e-9, 1e3),
        motor_friction_nm_s_rad in size_or_zero(1e-9, 1e4),
        load_inertia_kg_m2 in size(1e-9, 1e6),
        load_friction_nm_s_rad in size_or_zero(1e-9, 1e6),
        ratio in size(1e-3, 1e4),
        stiffness_nm_rad in size(1e-6, 1e9),
        dead_zone_rad in size(1e-6, 10.0),
    ) -> Mechanics {
        Mechanics {
            motor_inertia_kg_m2, motor_friction_nm_s_rad, load_inertia_kg_m2, load_friction_nm_s_rad, ratio,
            stiffness_nm_rad, dead_zone_rad,
        }
    }
}

prop_compose! {
    fn stribeck()(
        coulomb_nm in size_or_zero(1e-6, 1e5),
        more in prop_oneof![Just(1.0), 1.0..10.0],
        velocity_rad_s in size(1e-6, 1e3),
    ) -> StribeckParameters {
        StribeckParameters { coulomb_nm, stiction_nm: coulomb_nm * more, velocity_rad_s }
    }
}

prop_compose! {
    fn load_mode()(
        fraction in prop_oneof![Just(0.0), 0.0..=0.95],
        frequency_hz in size(0.1, 1e4),
        damping_ratio in 0.0..=1.0,
    ) -> LoadModeParameters {
        LoadModeParameters { fraction, frequency_hz, damping_ratio }
    }
}

prop_compose! {
    fn cogging()(amplitude_nm in size_or_zero(1e-6, 1e3), per_turn in size(1.0, 1e3)) -> CoggingParameters {
        CoggingParameters { amplitude_nm, per_turn }
    }
}

prop_compose! {
    fn parameters()(
        shaft_damping_nm_s_rad in size_or_zero(1e-12, 1e6),
        load in stribeck(),
        load_asymmetry in -0.9..=0.9,
        stiffness_nm_rad in size(1e-3, 1e12),
        damping_nm_s_rad in size_or_zero(1e-6, 1e9),
        bends in any::<bool>(),
        motor in stribeck(),
        motor_asymmetry in -0.9..=0.9,
        load_mode in load_mode(),
        cogging in cogging(),
        torque_offset_nm in signed(1e-6, 1e3),
        current_lag_s in size_or_zero(1e-9, 10.0),
        torque_saturation_nm in size(1e-6, 1e6),
    ) -> ShaftParameters {
        let load_bristles = (bends && load.coulomb_nm > 0.0)
            .then_some(BristleParameters { stiffness_nm_rad, damping_nm_s_rad });
        ShaftParameters {
            shaft_damping_nm_s_rad, load, load_asymmetry, load_bristles, load_mode, motor, motor_asymmetry, cogging,
            torque_offset_nm, current_lag_s, torque_saturation_nm,
        }
    }
}

prop_compose! {
    fn start()(
        load_position_rad in signed(1e-6, 1e4),
        load_velocity_rad_s in signed(1e-6, 1e4),
        twist in signed(1e-6, 1e2),
        motor_velocity_rad_s in signed(1e-6, 1e4),
    ) -> Start {
        Start {
            load_position_rad, load_velocity_rad_s, motor_position_rad: 3.0 * load_position_rad + twist,
            motor_velocity_rad_s,
        }
    }
}

fn all_finite(truth: &Truth) -> bool {
    [
        truth.load_position_rad,
        truth.load_velocity_rad_s,
        truth.motor_position_rad,
        truth.motor_velocity_rad_s,
        truth.motor_torque_nm,
        truth.twist_rad,
        truth.transmitted_torque_nm,
        truth.gap_position_rad,
        truth.load_dry_friction_nm,
        truth.motor_dry_friction_nm,
        truth.disturbing_torque_nm,
        truth.energy_j(),
        truth.supplied_energy_j,
        truth.dissipated_energy_j,
    ]
    .iter()
    .all(|number| number.is_finite())
}

/// Runs a plant until the torques end or the plant returns an error; every state before is finite.
fn run<P: TwoMass>(plant: P, start: Start, torques: &[f64], dt_s: f64) -> Result<(), TestCaseError> {
    let mut plant = RunningPlant::released(plant, start);
    for &torque_nm in torques {
        match plant.step(torque_nm, dt_s) {
            Ok(()) => prop_assert!(all_finite(&plant.truth()), "{:?}", plant.truth()),
            Err(
                PlantError::NotFinite { .. } | PlantError::TooStiff { .. } | PlantError::Chattering { .. },
            ) => break,
            Err(error) => prop_assert!(false, "{error}"),
        }
    }
    Ok(())
}

fn torques() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(signed(1e-6, 1e6), 1..20)
}

/// The same cases in every run. `PROPTEST_CASES=100000` adds further ones.
fn config() -> ProptestConfig {
    ProptestConfig {
        cases: ProptestConfig::default().cases.max(1024),
        rng_seed: RngSeed::Fixed(0x1a54_100b),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// A spring far too stiff for the step: without a limit its energy would overflow long before its coordinates.
#[test]
fn a_diverging_plant_returns_an_error_before_any_signal_overflows() {
    let mechanics = Mechanics {
        motor_inertia_kg_m2: 1.0,
        motor_friction_nm_s_rad: 0.0,
        load_inertia_kg_m2: 2.3e-6,
        load_friction_nm_s_rad: 0.0,
        ratio: 1.0,
        stiffness_nm_rad: 3.4e8,
        dead_zone_rad: 1.0,
    };
    let start = Start {
        load_position_rad: 51.0,
        load_velocity_rad_s: 1.0,
        motor_position_rad: 154.0,
        motor_velocity_rad_s: 1.0,
    };
    let mut plant = RunningPlant::released(Smooth::new(mechanics, 1).expect("in range"), start);
    let error = (0..100).find_map(|_| {
        let stepped = plant.step(1.0, 0.0044);
        assert!(stepped.is_err() || all_finite(&plant.truth()), "{:?}", plant.truth());
        stepped.err()
    });
    assert!(matches!(error, Some(PlantError::NotFinite { .. })), "{error:?}");
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn backlash_shaft_returns_finite_numbers_or_an_error(
        mechanics in mechanics(), parameters in parameters(), start in start(), torques in torques(),
        dt_s in size(1e-5, 1e-2), substeps in 1_u32..32,
    ) {
        let plant = BacklashShaft::new(mechanics, parameters, substeps).expect("every value is in its range");
        run(plant, start, &torques, dt_s)?;
    }

    #[test]
    fn other_plants_return_finite_numbers_or_an_error(
        mechanics in mechanics(), coulomb_nm in size_or_zero(1e-6, 1e6), start in start(), torques in torques(),
        dt_s in size(1e-5, 1e-2), substeps in 1_u32..32,
    ) {
        run(Smooth::new(mechanics, substeps).expect("in range"), start, &torques, dt_s)?;
        run(HardCoulomb::new(mechanics, coulomb_nm, substeps).expect("in range"), start, &torques, dt_s)?;
    }

    /// Within a factor of three of the paper's experiment every step succeeds and conserves energy.
    #[test]
    fn backlash_shaft_near_the_paper_never_fails(
        scale in prop::array::uniform10(0.33_f64..3.0), torques in prop::collection::vec(-10.0..10.0, 200),
        bends in any::<bool>(), asymmetry in -0.5..0.5, wear in 0.0..1e-3, load_torque_nm in -5.0..5.0,
        fraction in prop_oneof![Just(0.0), 0.0..0.9], frequency_hz in 5.0..50.0, amplitude_nm in 0.0..0.2,
    ) {
        let [a, b, c, d, e, f, g, h, i, j] = scale;
        let paper = Mechanics::paper();
        let mechanics = Mechanics {
            motor_inertia_kg_m2: a * paper.motor_inertia_kg_m2,
            load_inertia_kg_m2: b * paper.load_inertia_kg_m2,
            stiffness_nm_rad: c * paper.stiffness_nm_rad,
            dead_zone_rad: d * paper.dead_zone_rad,
            ..paper
        };
        let paper = ShaftParameters::paper();
        let stribeck = |of: StribeckParameters, size: f64, more: f64, velocity: f64| StribeckParameters {
            coulomb_nm: of.coulomb_nm * size,
            stiction_nm: of.coulomb_nm * size * (1.0 + 0.3 * more),
            velocity_rad_s: of.velocity_rad_s * velocity,
        };
        let parameters = ShaftParameters {
            shaft_damping_nm_s_rad: e * paper.shaft_damping_nm_s_rad,
            load: stribeck(paper.load, f, g, h),
            load_asymmetry: asymmetry,
            load_bristles: bends.then_some(BristleParameters { stiffness_nm_rad: 3.4e4 * i, damping_nm_s_rad: 300.0 }),
            motor: stribeck(paper.motor, g, h, i),
            motor_asymmetry: -asymmetry,
            load_mode: LoadModeParameters { fraction, frequency_hz, ..paper.load_mode },
            cogging: CoggingParameters { amplitude_nm, ..paper.cogging },
            current_lag_s: j * paper.current_lag_s,
            ..paper
        };
        let plant = BacklashShaft::new(mechanics, parameters, 16).expect("in range");
        let mut plant = RunningPlant::released(plant, Start::at_rest(0.0, 0.0));
        let start_j = plant.truth().energy_j();
        let mut turned_over_j = 1.0;
        for (k, torque_nm) in torques.into_iter().enumerate() {
            let environment = Environment { gap_growth_rad: wear * k as f64, load_torque_nm };
            plant.set_environment(environment).expect("in range");
            let before_j = plant.truth().supplied_energy_j;
            // Five milliseconds of each torque.
            for _ in 0..5 {
                plant.step(torque_nm, 1e-3).expect("the plant steps");
            }
            let truth = plant.truth();
            turned_over_j += (truth.supplied_energy_j - before_j).abs();
            let imbalance_j =
                truth.energy_j() - start_j - truth.supplied_energy_j + truth.dissipated_energy_j;
            prop_assert!(imbalance_j.abs() < 1e-5 * turned_over_j, "{imbalance_j} of {turned_over_j} J");
            prop_assert!(truth.gap_position_rad.abs() <= truth.dead_zone_rad + 1e-9, "{truth:?}");
            prop_assert!(truth.contact.sign() * truth.transmitted_torque_nm >= -1e-9, "{truth:?}");
        }
    }
}
