//! The regression on springs with a gap and an offset of the torque.

use nalgebra::{Matrix4, Vector4};

use super::{BALANCED_PERIODS, Estimate, Identification, Machine, ShaftSample};
use crate::law::Real;

fn machine<F: Real>() -> Machine<F> {
    let f = F::from_f64;
    Machine {
        stiffness_nm_rad: f(1.0),
        motor_inertia_kg_m2: f(1e-3),
        motor_coulomb_nm: f(0.0),
        torque_limit_nm: f(20.0),
        offset_deviation: f(0.006),
        ripple_deviation: f(0.0),
        speed_deviation: f(0.0),
        speed_limit_rad_s: f(1000.0),
        motor_count_rad: f(0.0),
        load_count_rad: f(0.0),
        initial_rad: f(0.3),
        max_rad: f(0.8),
        period_s: f(1e-3),
    }
}

/// Torques that wind the spring on both sides, or on the positive one.
fn to_and_fro_nm(k: i32) -> f64 {
    3.0 * (f64::from(k) * 1e-3).sin()
}

fn one_way_nm(k: i32) -> f64 {
    to_and_fro_nm(k).abs()
}

/// A motor that turns slowly, with its friction developed.
fn slow<F: Real>(transmitted_nm: F, twist_rad: F) -> ShaftSample<F> {
    ShaftSample {
        transmitted_nm,
        accelerating_nm: F::ZERO,
        twist_rad,
        twist_rate_rad_s: F::ZERO,
        motor_velocity_rad_s: F::ONE,
        friction: F::ONE,
    }
}

/// The prior values, with the motor balanced for long enough.
fn balanced<F: Real>(identification: &Identification<F>) -> Estimate<F> {
    Estimate { balanced_periods: BALANCED_PERIODS, ..identification.initial_estimate() }
}

/// The estimate after 20,000 observed torques at a spring of 1.3 rad/(N m) with half a gap of 0.1 rad, whose motor has an offset.
fn after(machine: &Machine<f64>, torque_nm: fn(i32) -> f64, offset_nm: f64) -> (f64, f64, f64) {
    let identification = Identification::new(machine);
    let mut estimate = balanced(&identification);
    for observed in (0..20_000).map(torque_nm) {
        let true_nm = observed + offset_nm;
        identification.step(&mut estimate, &slow(observed, 1.3 * true_nm + 0.1 * true_nm.signum()), false);
    }
    let gap = identification.gap(&estimate);
    (gap.compliance_rad_nm, gap.dead_zone_rad, identification.dead_zone_deviation_rad(&estimate))
}

#[test]
fn contact_on_both_flanks_tells_gap_and_compliance_from_the_offset() {
    for offset_nm in [0.0, 0.1, -0.2] {
        let (compliance, gap, deviation) = after(&machine(), to_and_fro_nm, offset_nm);
        assert!((compliance - 1.3).abs() < 2e-3, "{offset_nm} N m: {compliance} rad/(N m)");
        assert!((gap - 0.1).abs() < 4e-3 && deviation < 8e-3, "{offset_nm} N m: {gap} +- {deviation} rad");
    }
}

#[test]
fn one_flank_leaves_the_gap_as_uncertain_as_the_offset() {
    for offset_nm in [0.0, 0.1, -0.2] {
        let (_, gap, deviation) = after(&machine(), one_way_nm, offset_nm);
        // 0.006 of 20 N m at the nominal 1 rad/(N m), beside a prior value that knows the gap to 0.57 rad.
        assert!((deviation - 0.118).abs() < 0.005, "{deviation} rad");
        assert!((gap - 0.1).abs() < 2.0 * deviation, "{offset_nm} N m: {gap} +- {deviation} rad");
    }
    let exact = Machine { offset_deviation: 0.0, ..machine() };
    let (_, gap, deviation) = after(&exact, one_way_nm, 0.0);
    assert!((gap - 0.1).abs() < 2e-3 && deviation < 5e-3, "an exact torque: {gap} +- {deviation} rad");
}

#[test]
fn torque_that_grows_with_speed_is_not_taken_for_a_gap() {
    // A load that brakes: 1 to 3 N m against a motion of up to 40 rad/s, with 0.02 N m s/rad of unknown back-EMF.
    let estimate_of = |speed_deviation: f64| {
        let machine = Machine { speed_deviation, offset_deviation: 0.0, ..machine() };
        let identification = Identification::new(&machine);
        let mut estimate = balanced(&identification);
        for k in 0..20_000 {
            let true_nm = -2.0 - (f64::from(k) * 1e-3).sin();
            let motor_velocity_rad_s = 20.0 + 20.0 * (f64::from(k) * 3e-3).cos();
            let observed_nm = true_nm + 0.02 * motor_velocity_rad_s;
            let sample = ShaftSample { motor_velocity_rad_s, ..slow(observed_nm, true_nm - 0.1) };
            identification.step(&mut estimate, &sample, false);
        }
        let error_rad = identification.gap(&estimate).dead_zone_rad - 0.1;
        (error_rad, identification.dead_zone_deviation_rad(&estimate))
    };
    let (stated, deviation) = estimate_of(1.0);
    assert!(stated.abs() < 2.0 * deviation && deviation < 0.02, "{stated} rad, deviation {deviation} rad");
    let (unstated, deviation) = estimate_of(0.0);
    assert!(unstated.abs() > 4.0 * deviation, "{unstated} rad, deviation {deviation} rad");
}

#[test]
fn what_no_contact_can_tell_stays_in_the_deviation() {
    let deviation = |machine: Machine<f64>| after(&machine, to_and_fro_nm, 0.0).2;
    let rippled = deviation(Machine { ripple_deviation: 0.002, ..machine() });
    assert!((rippled / (1.3 * 0.04) - 1.0).abs() < 0.02, "ripple of 0.04 N m: {rippled} rad");
    let rubbing = deviation(Machine { motor_coulomb_nm: 0.5, ..machine() });
    assert!((rubbing / (1.3 * 0.3 * 0.5) - 1.0).abs() < 0.02, "friction of 0.5 N m: {rubbing} rad");
    let coarse = deviation(Machine { load_count_rad: 0.1, ..machine() });
    assert!(coarse > 0.05, "counts of 0.1 rad: {coarse} rad");
}

#[test]
fn nothing_learnt_is_as_uncertain_as_the_prior_value() {
    let identification = Identification::new(&machine::<f64>());
    let deviation = identification.dead_zone_deviation_rad(&identification.initial_estimate());
    assert!((deviation - 1.9 * 0.3).abs() < 1e-9, "{deviation} rad");
    let unknown = Identification::new(&Machine { initial_rad: 0.0, ..machine::<f64>() });
    let deviation = unknown.dead_zone_deviation_rad(&unknown.initial_estimate());
    assert!((deviation - 0.015 * 20.0).abs() < 1e-9, "{deviation} rad");
}

#[test]
fn spring_that_contradicts_the_model_shows_in_the_deviation() {
    let identification = Identification::new(&machine::<f64>());
    let deviation = |twist_rad: fn(f64) -> f64| {
        let mut estimate = balanced(&identification);
        for torque in (0..20_000).map(to_and_fro_nm) {
            identification.step(&mut estimate, &slow(torque, twist_rad(torque)), false);
        }
        identification.dead_zone_deviation_rad(&estimate)
    };
    let good = deviation(|torque| torque + 0.1 * torque.signum());
    let stiff = deviation(|torque| 0.2 * torque);
    let limited = deviation(|torque| torque.clamp(-1.0, 1.0) + 0.1 * torque.signum());
    assert!(good < 5e-3 && stiff > 0.05 && limited > 0.05, "{good}, {stiff}, {limited} rad");
}

#[test]
fn the_same_machine_in_other_units_learns_the_same() {
    // A hundredth of the torque, a tenth of the angle, ten times the speed.
    let small = Machine {
        stiffness_nm_rad: 0.1,
        motor_inertia_kg_m2: 1e-6,
        torque_limit_nm: 0.2,
        initial_rad: 0.03,
        max_rad: 0.08,
        period_s: 1e-4,
        ..machine::<f64>()
    };
    let (large, small) = (Identification::new(&machine::<f64>()), Identification::new(&small));
    let (mut at_large, mut at_small) = (balanced(&large), balanced(&small));
    for torque in (0..20_000).map(to_and_fro_nm) {
        let twist = 1.3 * torque + 0.1 * torque.signum();
        large.step(&mut at_large, &slow(torque, twist), false);
        small.step(&mut at_small, &slow(0.01 * torque, 0.1 * twist), false);
    }
    let (of_large, of_small) = (large.gap(&at_large), small.gap(&at_small));
    assert!((10.0 * of_small.dead_zone_rad / of_large.dead_zone_rad - 1.0).abs() < 1e-9);
    assert!((of_small.compliance_rad_nm / of_large.compliance_rad_nm / 10.0 - 1.0).abs() < 1e-9);
    let deviations = (large.dead_zone_deviation_rad(&at_large), small.dead_zone_deviation_rad(&at_small));
    assert!((10.0 * deviations.1 / deviations.0 - 1.0).abs() < 1e-6, "{deviations:?} rad");
}

#[test]
fn recursion_equals_the_batch_solution() {
    // Without drift, (P0^-1 + sum h h' / R) x = P0^-1 x0 + sum h y / R.
    let machine = Machine { speed_deviation: 0.5, ..machine::<f64>() };
    let identification = Identification { drift: 0.0, ..Identification::new(&machine) };
    let twist = |torque: f64| 1.2 * torque + (0.1 + 0.02 * (17.0 * torque).sin()) * torque.signum();
    let prior = balanced(&identification);
    let mut normal = Matrix4::from_diagonal(&prior.covariance.diagonal().map(|variance| 1.0 / variance));
    let mut information = normal * prior.parameters;
    let mut estimate = prior;
    for torque in (0..5000).map(to_and_fro_nm).filter(|torque| torque.abs() > 1.0) {
        let motor_velocity_rad_s = 10.0 + 7.0 * (5.0 * torque).cos();
        let regressor = Vector4::new(torque / 20.0, torque.signum(), 1.0, 1e-3 * motor_velocity_rad_s);
        let variance = identification.sample_variance * (1.0 + 0.075 * torque * torque);
        normal += regressor * regressor.transpose() / variance;
        information += regressor * (twist(torque) / 20.0) / variance;
        let sample = ShaftSample { motor_velocity_rad_s, ..slow(torque, twist(torque)) };
        identification.step(&mut estimate, &sample, false);
    }
    let residual = (normal * estimate.parameters - information).amax() / information.amax();
    assert!(residual < 1e-9, "{residual}");
}

#[test]
fn estimates_stay_in_their_bounds_for_any_measurement() {
    let identification = Identification::new(&machine::<f64>());
    // Far too compliant, far too stiff, and noise of no physical transmission.
    let twists: [fn(f64) -> f64; 3] =
        [|torque| 9.0 * torque, |torque| 0.01 * torque, |torque| torque * (1e4 * torque).sin().abs() * 50.0];
    for twist in twists {
        let mut estimate = balanced(&identification);
        for torque in (0..20_000).map(to_and_fro_nm) {
            identification.step(&mut estimate, &slow(torque, twist(torque)), false);
            let gap = identification.gap(&estimate);
            assert!((0.5..=2.0).contains(&gap.compliance_rad_nm), "{gap:?}");
            assert!((0.0..=0.8 + 1e-12).contains(&gap.dead_zone_rad), "{gap:?}");
        }
    }
}

#[test]
fn samples_that_say_nothing_of_the_gap_do_not_count() {
    let identification = Identification::new(&machine::<f64>());
    let prior = balanced(&identification);
    // Contact is certain from 0.24 N m and two deviations of 0.12 N m on; slow is 0.005 * 31.6 rad/s * 20 rad.
    let good = ShaftSample { twist_rate_rad_s: -3.1, ..slow(0.49, 1.0) };
    let after = |sample: ShaftSample<f64>, holds: bool| {
        let mut estimate = prior;
        identification.step(&mut estimate, &sample, holds);
        Estimate { balanced_periods: BALANCED_PERIODS, ..estimate }
    };
    assert_ne!(after(good, false), prior);
    for (what, sample) in [
        ("off contact", ShaftSample { twist_rad: -1.0, ..good }),
        ("of low torque", ShaftSample { transmitted_nm: 0.47, ..good }),
        ("in fast motion", ShaftSample { twist_rate_rad_s: -3.2, ..good }),
        ("of an accelerating motor", ShaftSample { accelerating_nm: 0.61, ..good }),
        ("of a motor at rest", ShaftSample { motor_velocity_rad_s: 0.0, ..good }),
        ("of a motor that turns back", ShaftSample { friction: 0.5, ..good }),
    ] {
        assert_eq!(after(sample, false), prior, "{what}");
    }
    assert_eq!(after(good, true), prior, "on hold");
    let mut estimate = identification.initial_estimate();
    for _ in 1..BALANCED_PERIODS {
        identification.step(&mut estimate, &good, false);
        assert_eq!(estimate.parameters, prior.parameters, "not balanced for long enough");
    }
    identification.step(&mut estimate, &good, false);
    assert_ne!(estimate.parameters, prior.parameters);
}

#[test]
fn constant_torque_with_noise_does_not_run_the_gap_away() {
    // Noise of the regressor flattens the slope: the compliance falls to the end of its range.
    let identification = Identification::new(&machine::<f64>());
    let mut estimate = balanced(&identification);
    for k in 0..60_000_i32 {
        let noise_nm = 0.2 * (f64::from(k) * 2.4).sin();
        identification.step(&mut estimate, &slow(10.0 + noise_nm, 10.1), false);
        let gap = identification.gap(&estimate);
        let predicted_rad = 10.0 * gap.compliance_rad_nm + gap.dead_zone_rad;
        // Whatever is learnt, it may be no more than the twist, of which 0.1 rad are gap.
        assert!(k < 100 || predicted_rad < 11.5, "sample {k}: {gap:?}");
    }
}

#[test]
fn the_estimate_follows_a_gap_that_wears() {
    let identification = Identification::new(&machine::<f64>());
    let mut estimate = balanced(&identification);
    let mut error_after = |samples: core::ops::Range<i32>, gap_rad: f64| {
        for torque in samples.map(to_and_fro_nm) {
            identification.step(&mut estimate, &slow(torque, torque + gap_rad * torque.signum()), false);
        }
        identification.gap(&estimate).dead_zone_rad - gap_rad
    };
    assert!(error_after(0..60_000, 0.1).abs() < 2e-3);
    let (at_once, later) = (error_after(60_000..60_010, 0.3), error_after(60_010..120_000, 0.3));
    assert!(at_once < -0.15 && later.abs() < 0.03, "{at_once} rad, a minute later {later} rad");
}

#[test]
fn a_million_samples_keep_single_precision_stable() {
    let identification = Identification::new(&machine::<f32>());
    let exactly = Identification::new(&machine::<f64>());
    let (mut estimate, mut exact): (Estimate<f32>, _) = (balanced(&identification), balanced(&exactly));
    for torque in (0..1_000_000).map(to_and_fro_nm) {
        let twist = 1.3 * torque + 0.1 * torque.signum();
        identification.step(&mut estimate, &slow(torque as f32, twist as f32), false);
        exactly.step(&mut exact, &slow(torque, twist), false);
        let variances = estimate.covariance.diagonal();
        assert!(variances.x > 0.0 && variances.y > 0.0 && variances.z >= 0.0, "{variances:?}");
    }
    let have = f64::from(identification.gap(&estimate).dead_zone_rad);
    let want = exactly.gap(&exact).dead_zone_rad;
    assert!((have - want).abs() < 1e-3, "{have} rad, in double precision {want} rad");
    let have = f64::from(identification.dead_zone_deviation_rad(&estimate));
    let want = exactly.dead_zone_deviation_rad(&exact);
    assert!((have - want).abs() < 1e-3, "deviation {have} rad, in double precision {want} rad");
}
