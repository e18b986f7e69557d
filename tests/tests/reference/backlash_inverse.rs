//! The backlash inverse on the backlash shaft, on the paper's smooth plant, and on two hundred random plants.

use core::fmt::Write;
use std::thread;

use battery::plants::RandomPlants;
use lashloop_firmware::law::Real;
use lashloop_plant::backlash_shaft::{ShaftParameters, StribeckParameters};
use lashloop_plant::{Mechanics, Start};

use crate::both_precisions::BothPrecisions;
use crate::closed_loop::{Reference, Timing, regulate_to_zero, run};
use crate::drive_train::{DriveTrain, Figures, HEADER};
use crate::paper;
use crate::trajectory::load_distance_rad;

/// Asserts the law's limits on the drive train of the paper's experiment.
fn meets(figures: &Figures, what: &str) {
    assert!(figures.settle_s.is_some_and(|settle_s| settle_s < 2.8), "{what}: {figures:?}");
    assert!(figures.static_error_rad.abs() < 2e-3, "{what}: {figures:?}");
    assert!(figures.hunting_rad < 0.5e-3, "{what}: {figures:?}");
    assert!(figures.torque_variation_nm < 260.0, "{what}: {figures:?}");
    assert!(figures.dead_zone_error_rad.abs() < 0.015, "{what}: {figures:?}");
}

#[test]
fn three_laws_on_the_backlash_shaft() {
    let drive_train = DriveTrain::paper();
    let mut table = format!("{:<16} {HEADER} lost motion mrad\n", "law");
    let mut add = |name: &str, figures: &Figures, lost_motion_rad: f64| {
        writeln!(table, "{name:<16} {figures} {:>10.1}", lost_motion_rad * 1e3).expect("writing to a string");
    };
    for (name, law) in [("pd, f32", paper::pd::<f32>()), ("merzouki, f32", paper::merzouki_observed(1e-3))] {
        add(name, &Figures::of(&drive_train.regulate(&law)), drive_train.lost_motion_rad(&law));
    }
    let (single, double) = (drive_train.backlash_inverse::<f32>(), drive_train.backlash_inverse::<f64>());
    let rows = (drive_train.regulate(&single), drive_train.regulate(&double));
    for (name, rows, lost_motion_rad) in [
        ("backlash-inverse f32", &rows.0, drive_train.lost_motion_rad(&single)),
        ("backlash-inverse f64", &rows.1, drive_train.lost_motion_rad(&double)),
    ] {
        let figures = Figures::of(rows);
        meets(&figures, name);
        assert!(lost_motion_rad < 3e-3, "{name}: {lost_motion_rad} rad of lost motion");
        add(name, &figures, lost_motion_rad);
    }
    let distance = load_distance_rad(&rows.0, &rows.1);
    assert!(distance < 1e-3, "single and double precision are {distance} rad apart");
    insta::assert_snapshot!(table);
}

#[test]
fn gap_delay_and_resolution_hardly_change_the_figures() {
    let mut table = format!("{:<16} {HEADER}\n", "");
    let paper = DriveTrain::paper();
    let wide = |dead_zone_rad: f64| {
        let mut drive_train = paper;
        drive_train.mechanics.dead_zone_rad = dead_zone_rad;
        (format!("j0 {dead_zone_rad} rad"), drive_train)
    };
    let late = |delay_us: u32| (format!("{delay_us} us late"), DriveTrain { delay_us, ..paper });
    let fine = |counts: u32| (format!("{counts} counts"), DriveTrain { counts, ..paper });
    let variants = [0.02, 0.08, 0.4].map(wide).into_iter().chain([0, 4000, 8000].map(late));
    for (name, drive_train) in variants.chain([10_000, 1 << 17].map(fine)) {
        let figures = Figures::of(&drive_train.regulate(&drive_train.backlash_inverse::<f32>()));
        meets(&figures, &name);
        writeln!(table, "{name:<16} {figures}").expect("writing to a string");
    }
    insta::assert_snapshot!(table);
}

#[test]
fn weak_drive_arrives_late_but_without_overshoot() {
    for torque_limit_nm in [2.0, 3.0, 5.0] {
        let drive_train = DriveTrain { torque_limit_nm, ..DriveTrain::paper() };
        let rows = drive_train.regulate(&drive_train.backlash_inverse::<f32>());
        let saturated = rows.iter().filter(|row| row.torque_nm.abs() == torque_limit_nm).count();
        assert!(saturated > 100, "{torque_limit_nm} N m: {saturated} samples at the limit");
        let figures = Figures::of(&rows);
        assert!(figures.settle_s.is_some_and(|settle_s| settle_s < 11.0), "{torque_limit_nm}: {figures:?}");
        assert!(figures.static_error_rad.abs() < 2e-3, "{torque_limit_nm} N m: {figures:?}");
        assert!(figures.hunting_rad < 0.5e-3, "{torque_limit_nm} N m: {figures:?}");
        let lowest = rows.iter().map(|row| row.truth.load_position_rad).fold(f64::MAX, f64::min);
        assert!(lowest > -2e-3, "{torque_limit_nm} N m: overshoots to {lowest} rad");
    }
}

#[test]
fn smooth_gap_needs_no_other_gains() {
    // The law models a hard gap: on the smooth curve it identifies a chord, up to 4 j0 wide.
    let drive_train = DriveTrain::paper();
    let timing = Timing { torque_limit_nm: 20.0, ..Timing::RECORDED };
    let rows = run(
        &paper::smooth(4),
        paper::START,
        &drive_train.backlash_inverse::<f32>(),
        drive_train.sensors(),
        regulate_to_zero,
        timing,
    );
    let figures = Figures::of(&rows);
    assert!(figures.settle_s.is_some_and(|settle_s| settle_s < 2.0), "{figures:?}");
    assert!(figures.static_error_rad.abs() < 2e-3 && figures.hunting_rad < 2e-3, "{figures:?}");
    let estimate = rows.last().expect("rows").dead_zone_estimate_rad;
    assert!((0.45..0.64).contains(&estimate), "have {estimate} rad");
}

/// The drive train of a plant of the battery.
fn random_drive_train(plants: &RandomPlants, index: u32) -> DriveTrain {
    let plant = plants.plant(index).expect("a plant");
    let number = |key: &str| plant.number(key).unwrap_or_else(|| panic!("a number of {key}"));
    let mechanics = Mechanics {
        motor_inertia_kg_m2: number("plant.motor_inertia_kg_m2"),
        motor_friction_nm_s_rad: number("plant.motor_friction_nm_s_rad"),
        load_inertia_kg_m2: number("plant.load_inertia_kg_m2"),
        load_friction_nm_s_rad: number("plant.load_friction_nm_s_rad"),
        stiffness_nm_rad: number("plant.stiffness_nm_rad"),
        dead_zone_rad: number("plant.dead_zone_rad"),
        ..Mechanics::paper()
    };
    let friction = |side: &str| StribeckParameters {
        coulomb_nm: number(&format!("plant.{side}_coulomb_nm")),
        stiction_nm: number(&format!("plant.{side}_stiction_nm")),
        velocity_rad_s: number(&format!("plant.{side}_stribeck_rad_s")),
    };
    let parameters = ShaftParameters {
        shaft_damping_nm_s_rad: number("plant.shaft_damping_nm_s_rad"),
        load: friction("load"),
        motor: friction("motor"),
        current_lag_s: number("plant.current_lag_ms") / 1e3,
        ..ShaftParameters::paper()
    };
    let counts = number("encoders.load_counts_per_rev") as u32;
    DriveTrain { mechanics, parameters, counts, ..DriveTrain::paper() }
}

/// Figures of the backlash inverse, with its default gains, on random drive trains.
fn on_random_drive_trains<F: Real>(delay_us: u32) -> Vec<Figures> {
    let plants = RandomPlants::new(1).expect("the plants");
    let drive_trains: Vec<_> =
        (0..200).map(|index| DriveTrain { delay_us, ..random_drive_train(&plants, index) }).collect();
    let run =
        |drive_train: &DriveTrain| Figures::of(&drive_train.regulate(&drive_train.backlash_inverse::<F>()));
    thread::scope(|scope| {
        let halves: Vec<_> = drive_trains
            .chunks(100)
            .map(|half| scope.spawn(move || half.iter().map(run).collect::<Vec<_>>()))
            .collect();
        halves.into_iter().flat_map(|half| half.join().expect("no run panics")).collect()
    })
}

fn sorted(all: &[Figures], of: impl Fn(&Figures) -> f64) -> Vec<f64> {
    let mut values: Vec<_> = all.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values
}

#[test]
fn two_hundred_random_plants_meet_the_limits() {
    let mut table = format!(
        "{:<12} {:>10} {:>8} {:>15} {:>16} {:>22} {:>14}\n",
        "200 plants",
        "settle p95",
        "max s",
        "static max mrad",
        "hunting max mrad",
        "gap error med/p95 mrad",
        "variation max"
    );
    for (name, all) in [
        ("f32", on_random_drive_trains::<f32>(1000)),
        ("f64", on_random_drive_trains::<f64>(1000)),
        ("f32, 8 ms", on_random_drive_trains::<f32>(8000)),
    ] {
        let settle = sorted(&all, |it| it.settle_s.unwrap_or(f64::INFINITY));
        let still = sorted(&all, |it| it.static_error_rad.abs() * 1e3);
        let hunting = sorted(&all, |it| it.hunting_rad * 1e3);
        let gap = sorted(&all, |it| it.dead_zone_error_rad.abs() * 1e3);
        let variation = sorted(&all, |it| it.torque_variation_nm);
        assert!(settle[190] < 3.0, "{name}: 95 % settle within {} s", settle[190]);
        assert!(still[199] < 3.5, "{name}: static error up to {} mrad", still[199]);
        assert!(hunting[199] < 1.5, "{name}: hunting up to {} mrad", hunting[199]);
        assert!(gap[190] < 25.0, "{name}: 95 % identify the gap within {} mrad", gap[190]);
        writeln!(
            table,
            "{name:<12} {:>10.2} {:>8.2} {:>15.1} {:>16.2} {:>22} {:>14.0}",
            settle[190],
            settle[199],
            still[199],
            hunting[199],
            format!("{:.0} / {:.0}", gap[100], gap[190]),
            variation[199],
        )
        .expect("writing to a string");
    }
    insta::assert_snapshot!(table);
}

#[test]
fn single_precision_computes_the_same_torque() {
    let mut table = String::from("counts   largest difference of torque, N m\n");
    for counts in [4000, 10_000, 1 << 17] {
        let drive_train = DriveTrain { counts, ..DriveTrain::paper() };
        let laws = (drive_train.backlash_inverse(), drive_train.backlash_inverse());
        let mut largest_nm = 0.0;
        let sensors =
            BothPrecisions::new((drive_train.sensors(), drive_train.sensors()), laws, &mut largest_nm);
        let rows = drive_train.follow(
            &drive_train.backlash_inverse(),
            sensors,
            paper::START,
            25_000,
            regulate_to_zero,
        );
        meets(&Figures::of(&rows), "in double precision");
        // One rounding of 16 N m is 1e-6; compliance and gap are sums of some thousand rounded increments, and the
        // compliance is multiplied by up to 8 N m.
        assert!(largest_nm < 5e-4, "{counts} counts: have {largest_nm:e} N m");
        writeln!(table, "{counts:<8} {largest_nm:.0e}").expect("writing to a string");
    }
    insta::assert_snapshot!(table);
}

#[test]
fn law_is_the_same_far_from_zero() {
    // A hundred turns of the load, three hundred of the motor: an f32 resolves 6e-8 of 628 rad, 0.04 mrad.
    let drive_train = DriveTrain { counts: 1 << 17, ..DriveTrain::paper() };
    let away = 628.0;
    let start = Start::at_rest(away + 1.5, 3.0 * (away + 1.5));
    let reference = |_: f64| Reference { position_rad: away, velocity_rad_s: 0.0, acceleration_rad_s2: 0.0 };
    let rows = drive_train.follow(
        &drive_train.backlash_inverse::<f32>(),
        drive_train.sensors(),
        start,
        25_000,
        reference,
    );
    let last = rows.last().expect("rows").truth.load_position_rad - away;
    assert!(last.abs() < 2.5e-3, "ends {last} rad from the reference");
}
