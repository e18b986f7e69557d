//! The backlash inverse on the bench plant, beside the paper's, and on two hundred others.

use core::fmt::Write;
use std::thread;

use lashloop::campaign::plants::RandomPlant;
use lashloop_firmware::control::Real;
use lashloop_plant::Start;

use crate::closed_loop::{Reference, Timing, regulate_to_nought, run};
use crate::listener::Listener;
use crate::machine::{Figures, HEAD, Machine};
use crate::paper;
use crate::paper_loops::load_distance_rad;

/// What the law is to keep on the bench that stands for the paper's experiment.
fn meets(figures: &Figures, what: &str) {
    assert!(figures.settle_s.is_some_and(|settle_s| settle_s < 2.8), "{what}: {figures:?}");
    assert!(figures.static_error_rad.abs() < 2e-3, "{what}: {figures:?}");
    assert!(figures.hunting_rad < 0.5e-3, "{what}: {figures:?}");
    assert!(figures.torque_variation_nm < 260.0, "{what}: {figures:?}");
    assert!(figures.dead_zone_error_rad.abs() < 0.015, "{what}: {figures:?}");
}

#[test]
fn three_laws_on_the_bench() {
    let machine = Machine::paper();
    let mut table = format!("{:<16} {HEAD} lost motion mrad\n", "law");
    let mut add = |name: &str, figures: &Figures, lost_motion_rad: f64| {
        writeln!(table, "{name:<16} {figures} {:>10.1}", lost_motion_rad * 1e3).expect("writing to a string");
    };
    for (name, law) in [("pd, f32", paper::pd::<f32>()), ("merzouki, f32", paper::merzouki_observed(1e-3))] {
        add(name, &Figures::of(&machine.regulate(&law)), machine.lost_motion_rad(&law));
    }
    let (single, double) = (machine.backlash_inverse::<f32>(), machine.backlash_inverse::<f64>());
    let rows = (machine.regulate(&single), machine.regulate(&double));
    for (name, rows, lost_motion_rad) in [
        ("backlash-inverse f32", &rows.0, machine.lost_motion_rad(&single)),
        ("backlash-inverse f64", &rows.1, machine.lost_motion_rad(&double)),
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
fn nothing_of_it_depends_on_the_width_of_the_gap_on_delay_or_on_fine_encoders() {
    let mut table = format!("{:<16} {HEAD}\n", "");
    let paper = Machine::paper();
    let wide = |dead_zone_rad: f64| {
        let mut machine = paper;
        machine.mechanics.dead_zone_rad = dead_zone_rad;
        (format!("j0 {dead_zone_rad} rad"), machine)
    };
    let late = |delay_us: u32| (format!("{delay_us} us late"), Machine { delay_us, ..paper });
    let fine = |counts: u32| (format!("{counts} counts"), Machine { counts, ..paper });
    let variants = [0.02, 0.08, 0.4].map(wide).into_iter().chain([0, 4000, 8000].map(late));
    for (name, machine) in variants.chain([10_000, 1 << 17].map(fine)) {
        let figures = Figures::of(&machine.regulate(&machine.backlash_inverse::<f32>()));
        meets(&figures, &name);
        writeln!(table, "{name:<16} {figures}").expect("writing to a string");
    }
    insta::assert_snapshot!(table);
}

#[test]
fn a_weak_drive_takes_its_time_and_arrives_all_the_same() {
    for torque_limit_nm in [2.0, 3.0, 5.0] {
        let machine = Machine { torque_limit_nm, ..Machine::paper() };
        let rows = machine.regulate(&machine.backlash_inverse::<f32>());
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
fn smooth_gap_needs_no_switch() {
    // The same gains know nothing of tanh: what they identify is the smooth curve's chord, up to 4 j0 wide.
    let machine = Machine::paper();
    let timing = Timing { torque_limit_nm: 20.0, ..Timing::RECORDED };
    let rows = run(
        &paper::smooth(4),
        paper::START,
        &machine.backlash_inverse::<f32>(),
        machine.sensors(),
        regulate_to_nought,
        timing,
    );
    let figures = Figures::of(&rows);
    assert!(figures.settle_s.is_some_and(|settle_s| settle_s < 2.0), "{figures:?}");
    assert!(figures.static_error_rad.abs() < 2e-3 && figures.hunting_rad < 2e-3, "{figures:?}");
    let estimate = rows.last().expect("rows").dead_zone_estimate_rad;
    assert!((0.45..0.64).contains(&estimate), "have {estimate} rad");
}

/// A plant of the battery.
fn some_machine(index: u32) -> Machine {
    let RandomPlant { mechanics, parameters, counts_per_rev: counts } = RandomPlant::draw(1, index);
    Machine { mechanics, parameters, counts, ..Machine::paper() }
}

/// Figures of the backlash inverse on machines nobody tuned it for.
fn on_random_machines<F: Real>(delay_us: u32) -> Vec<Figures> {
    let machines: Vec<_> = (0..200).map(|index| Machine { delay_us, ..some_machine(index) }).collect();
    let run = |machine: &Machine| Figures::of(&machine.regulate(&machine.backlash_inverse::<F>()));
    thread::scope(|scope| {
        let halves: Vec<_> = machines
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
fn two_hundred_plants_that_nobody_tuned_it_for() {
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
        ("f32", on_random_machines::<f32>(1000)),
        ("f64", on_random_machines::<f64>(1000)),
        ("f32, 8 ms", on_random_machines::<f32>(8000)),
    ] {
        let settle = sorted(&all, |it| it.settle_s.unwrap_or(f64::INFINITY));
        let still = sorted(&all, |it| it.static_error_rad.abs() * 1e3);
        let hunting = sorted(&all, |it| it.hunting_rad * 1e3);
        let gap = sorted(&all, |it| it.dead_zone_error_rad.abs() * 1e3);
        let variation = sorted(&all, |it| it.torque_variation_nm);
        assert!(settle[190] < 3.0, "{name}: 95 % settle within {} s", settle[190]);
        assert!(still[199] < 3.5, "{name}: static error up to {} mrad", still[199]);
        assert!(hunting[199] < 1.5, "{name}: hunting up to {} mrad", hunting[199]);
        assert!(gap[190] < 25.0, "{name}: 95 % know the gap within {} mrad", gap[190]);
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
fn single_precision_answers_the_same_counts_with_the_same_torque() {
    let mut table = String::from("counts   largest difference of torque, N m\n");
    for counts in [4000, 10_000, 1 << 17] {
        let machine = Machine { counts, ..Machine::paper() };
        let laws = (machine.backlash_inverse(), machine.backlash_inverse());
        let mut largest_nm = 0.0;
        let listener = Listener::new((machine.sensors(), machine.sensors()), laws, &mut largest_nm);
        let rows =
            machine.follow(&machine.backlash_inverse(), listener, paper::START, 25_000, regulate_to_nought);
        meets(&Figures::of(&rows), "in double precision");
        // One rounding of 16 N m is 1e-6; compliance and gap are sums of some thousand rounded increments, and the
        // compliance is multiplied by up to 8 N m.
        assert!(largest_nm < 5e-4, "{counts} counts: have {largest_nm:e} N m");
        writeln!(table, "{counts:<8} {largest_nm:.0e}").expect("writing to a string");
    }
    insta::assert_snapshot!(table);
}

#[test]
fn far_from_nought_the_law_is_the_same() {
    // A hundred turns of the load away, three hundred of the motor: 2 mrad are 6e-5 of it, an f32 resolves 6e-8.
    let machine = Machine { counts: 1 << 17, ..Machine::paper() };
    let away = 628.0;
    let start = Start::at_rest(away + 1.5, 3.0 * (away + 1.5));
    let there = |_: f64| Reference { position_rad: away, velocity_rad_s: 0.0, acceleration_rad_s2: 0.0 };
    let rows = machine.follow(&machine.backlash_inverse::<f32>(), machine.sensors(), start, 25_000, there);
    let last = rows.last().expect("rows").truth.load_position_rad - away;
    assert!(last.abs() < 2.5e-3, "ends {last} rad beside the reference");
}
