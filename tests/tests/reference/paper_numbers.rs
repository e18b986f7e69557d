//! The paper's numbers: with ideal sensors in double precision, and with encoders in the drive's single precision.

use core::fmt::Write;

use lashloop_firmware::law::Real;

use crate::closed_loop::{Ideal, Quantised};
use crate::paper_loops::{Loop, Measures, TORQUE_LIMIT_NM};
use crate::trajectory::load_distance_rad;

/// Encoders and bandwidths that reproduce the paper's numbers with the widest margin. Half the bandwidth at the load
/// halves the noise of the torque and still reproduces them.
const COUNTS: u32 = 16_384;
const MOTOR_BANDWIDTH_RAD_S: f64 = 400.0;
const LOAD_BANDWIDTH_RAD_S: f64 = 200.0;

fn seconds(settle_s: Option<f64>) -> String {
    settle_s.map_or_else(|| "never".to_owned(), |settle_s| format!("{settle_s:.2}"))
}

fn row(table: &mut String, sensors: &str, measures: &Measures, single_to_double_rad: Option<f64>) {
    let distance = single_to_double_rad.map_or_else(|| "-".to_owned(), |distance| format!("{distance:.0e}"));
    writeln!(
        table,
        "{sensors:<12} {:>9} {:>10.4} {:>8.3} {:>8.2} {:>9.0} {distance:>12}",
        seconds(measures.settle_s),
        measures.final_error_rad + 0.0,
        measures.final_estimate_rad,
        measures.largest_torque_nm,
        measures.torque_variation_nm,
    )
    .expect("writing to a string");
}

#[test]
fn four_loops_of_the_paper() {
    let mut table = String::new();
    for closed in Loop::ALL {
        writeln!(
            table,
            "\n{}\n{:<12} {:>9} {:>10} {:>8} {:>8} {:>9} {:>12}",
            closed.name(),
            "sensors",
            "settle s",
            "at 25 s",
            "j_hat",
            "max |U|",
            "variation",
            "f32 to f64"
        )
        .expect("writing to a string");
        let double = closed.run::<f64>(Ideal);
        row(&mut table, "ideal, f64", &Measures::of(&double), None);
        let single = closed.run::<f32>(Ideal);
        row(&mut table, "ideal, f32", &Measures::of(&single), Some(load_distance_rad(&single, &double)));
        for counts in [1_000, 4_000, 10_000, COUNTS, 1 << 17, 1 << 20] {
            let single = closed.run(quantised::<f32>(counts));
            let double = closed.run(quantised::<f64>(counts));
            let distance = load_distance_rad(&single, &double);
            row(&mut table, &format!("{counts}, f32"), &Measures::of(&single), Some(distance));
        }
    }
    insta::assert_snapshot!(table);
}

fn quantised<F: Real>(counts: u32) -> Quantised<F> {
    Quantised::new(counts, MOTOR_BANDWIDTH_RAD_S, LOAD_BANDWIDTH_RAD_S, 1e-3)
}

#[test]
fn drive_with_fine_encoders_reproduces_the_paper() {
    let of = |closed: Loop| Measures::of(&closed.run(quantised::<f32>(COUNTS)));
    let settle = |closed: Loop| of(closed).settle_s.expect("settles");
    let near = |what: &str, have: f64, want: f64, tolerance: f64| {
        assert!((have - want).abs() <= tolerance, "{what}: have {have}, want {want} +- {tolerance}");
    };
    near("smooth pd settles, s", settle(Loop::SmoothPd), 12.9, 0.15);
    near("smooth merzouki settles, s", settle(Loop::SmoothMerzouki), 5.14, 0.1);
    near("hard-coulomb pd ends, rad", of(Loop::HardCoulombPd).final_error_rad, 0.32, 0.002);
    near("hard-coulomb merzouki ends, rad", of(Loop::HardCoulombMerzouki).final_error_rad, 0.0, 0.015);
    for closed in Loop::ALL {
        let largest = of(closed).largest_torque_nm;
        assert!(largest < TORQUE_LIMIT_NM, "{}: {largest} N m touches the limit", closed.name());
    }
}

#[test]
fn bandwidths_and_counts_that_meet_the_paper() {
    let mut table = format!(
        "{:>8} {:>11} {:>10} {:>10} {:>15} {:>15} {:>15} {:>10} {:>6}\n",
        "counts",
        "motor rad/s",
        "load rad/s",
        "smooth pd",
        "smooth merzouki",
        "hard pd at 25 s",
        "hard f at 25 s",
        "variation",
        "meets"
    );
    for counts in [4_000, 10_000, COUNTS, 1 << 17] {
        for (motor, load) in [
            (400.0, 30.0),
            (400.0, 60.0),
            (400.0, 100.0),
            (400.0, 200.0),
            (400.0, 400.0),
            (200.0, 200.0),
            (1000.0, 1000.0),
        ] {
            let of =
                |closed: Loop| Measures::of(&closed.run(Quantised::<f32>::new(counts, motor, load, 1e-3)));
            let [pd, merzouki, hard_pd, hard_merzouki] = Loop::ALL.map(of);
            let near = |have: Option<f64>, want: f64, tolerance: f64| {
                have.is_some_and(|have| (have - want).abs() <= tolerance)
            };
            let meets = near(pd.settle_s, 12.9, 0.15)
                && near(merzouki.settle_s, 5.14, 0.1)
                && near(Some(hard_pd.final_error_rad), 0.32, 0.002)
                && near(Some(hard_merzouki.final_error_rad), 0.0, 0.015);
            writeln!(
                table,
                "{counts:>8} {motor:>11} {load:>10} {:>10} {:>15} {:>15.4} {:>15.4} {:>10.0} {:>6}",
                seconds(pd.settle_s),
                seconds(merzouki.settle_s),
                hard_pd.final_error_rad,
                hard_merzouki.final_error_rad,
                hard_merzouki.torque_variation_nm,
                if meets { "yes" } else { "no" },
            )
            .expect("writing to a string");
        }
    }
    insta::assert_snapshot!(table);
}
