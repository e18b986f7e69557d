//! The scenarios of the plant `backlash-shaft`: each passes with its own law; the PD law fails all but its own two.

use tests::program;
use tests::records::{Records, Trace};

/// Name without `shaft-`, metric, recorded value, tolerance.
const SCENARIOS: [(&str, &str, f64, f64); 9] = [
    ("pd", "static_error_rad", 0.3196, 0.001),
    ("pd-sine", "lost_motion_rad", 0.3587, 0.001),
    ("merzouki", "settle_time_s", 5.89, 0.2),
    ("sine", "lost_motion_rad", 0.0, 0.01),
    ("triangle", "lost_motion_rad", 0.019, 0.01),
    ("move", "settle_time_s", 4.6, 0.5),
    ("load-step", "settle_time_s", 24.7, 2.0),
    ("worn", "lost_motion_rad", 0.0, 0.01),
    ("reversing-friction", "lost_motion_rad", 0.015, 0.01),
];

/// Those of the braking curve: the nominal plant is among the pinned runs.
const BRAKING_CURVE: [(&str, &str, f64, f64); 4] = [
    ("braking-curve-sine", "lost_motion_rad", 0.0002, 0.0001),
    ("braking-curve-heavy", "overshoot_rad", 0.0019, 0.0005),
    ("braking-curve-pushed", "settle_time_s", 1.500, 0.05),
    ("braking-curve-weak-motor", "settle_time_s", 2.808, 0.05),
];

fn path(name: &str) -> String {
    format!("scenarios/shaft-{name}.toml")
}

fn trace(name: &str) -> Trace {
    let records = Records::new();
    let _ = program::run(["run", &path(name), "--device", "inproc", "--out", &records.out()]).with_code(0);
    records.trace()
}

#[test]
fn every_shaft_scenario_passes_with_its_own_law() {
    for (name, metric, want, tolerance) in SCENARIOS.into_iter().chain(BRAKING_CURVE) {
        let records = Records::new();
        let _ =
            program::run(["run", &path(name), "--device", "inproc", "--out", &records.out()]).with_code(0);
        let have = records.summary()["metrics"][metric].as_f64().unwrap_or(f64::NAN);
        assert!((have - want).abs() <= tolerance, "{name}: {metric} {have}, want {want} +- {tolerance}");
    }
}

#[test]
fn pd_fails_every_shaft_scenario_but_its_own_two() {
    for (name, ..) in SCENARIOS.into_iter().filter(|(name, ..)| !name.starts_with("pd")) {
        let _ = program::run(["run", &path(name), "--device", "inproc", "--controller", "pd"]).with_code(1);
    }
}

#[test]
fn energies_of_a_trace_balance_under_load_and_wear() {
    for name in ["merzouki", "load-step", "worn", "reversing-friction"] {
        let trace = trace(name);
        let [stored, supplied, dissipated] = ["stored_energy_j", "supplied_energy_j", "dissipated_energy_j"]
            .map(|column| trace.column(column));
        let turned_over_j: f64 = supplied.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        let worst_j = (0..trace.len())
            .map(|row| (stored[row] - stored[0] - supplied[row] + dissipated[row]).abs())
            .fold(0.0, f64::max);
        assert!(worst_j < 2e-8 * turned_over_j, "{name}: {worst_j} J of {turned_over_j} J");
        assert!(turned_over_j > 10.0, "{name}: {turned_over_j} J");
    }
}

#[test]
fn the_torque_reaches_the_motor_a_millisecond_later() {
    let trace = trace("merzouki");
    let (commanded, delivered) = (trace.column("torque_nm"), trace.column("motor_torque_nm"));
    // With T_i = 0.5 ms the motor torque is e^-2 of a change short of the command after the millisecond of its hold.
    assert_eq!(delivered[..2], [0.0, 0.0]);
    for row in 1..200 {
        let want = commanded[row - 1] + (delivered[row] - commanded[row - 1]) * (-2.0_f64).exp();
        let have = delivered[row + 1];
        assert!((have - want).abs() < 1e-12, "row {}: have {have}, want {want} N m", row + 1);
    }
}

#[test]
fn load_and_wear_begin_at_their_scenario_times() {
    let load = trace("load-step").column("load_torque_nm");
    assert_eq!([9_999, 10_000, 19_999, 20_000].map(|row: usize| load[row]), [0.0, 12.0, 12.0, 0.0]);
    let gap = trace("worn").column("dead_zone_rad");
    for (row, want) in [(0, 0.16), (20_000, 0.16), (40_000, 0.24), (60_000, 0.32), (104_999, 0.32)] {
        assert!((gap[row] - want).abs() < 1e-12, "row {row}: have {} rad, want {want} rad", gap[row]);
    }
}

fn with_bristles_of(stiffness_nm_rad: &str, code: i32) -> program::Ended {
    law_with_bristles_of("pd", stiffness_nm_rad, code)
}

fn law_with_bristles_of(law: &str, stiffness_nm_rad: &str, code: i32) -> program::Ended {
    let stiffness = format!("plant.bristle_stiffness_nm_rad={stiffness_nm_rad}");
    let bristles = ["--set", "plant.load_friction=\"lugre\"", "--set", &stiffness];
    let scenario = path(law);
    let arguments = ["run", &scenario, "--device", "inproc", "--details"];
    program::run(arguments.into_iter().chain(bristles)).with_code(code)
}

#[test]
fn a_plant_too_stiff_to_integrate_is_rejected_before_the_run() {
    let ended = with_bristles_of("1e12", 2);
    assert!(ended.stderr.contains("plant is too stiff"), "{}", ended.stderr);
}

#[test]
fn a_plant_that_becomes_too_stiff_makes_the_run_invalid() {
    let ended = with_bristles_of("1e8", 3);
    assert!(ended.stdout.contains("plant is too stiff"), "{}", ended.stdout);
    assert!(ended.stdout.starts_with("INVALID  "), "{}", ended.stdout);
    // A measurement of part of the run isn't a metric of the run.
    assert!(ended.stdout.contains("no value    settle_time_s: not finite\n"), "{}", ended.stdout);
}

#[test]
fn lugre_bristles_preserve_the_static_error() {
    let ended = with_bristles_of("3.4e4", 0);
    assert!(ended.stdout.starts_with("PASS  "), "{}", ended.stdout);
}

#[test]
fn braking_curve_meets_its_expectations_with_bristles() {
    for stiffness_nm_rad in ["3.4e4", "3.4e5"] {
        let ended = law_with_bristles_of("braking-curve", stiffness_nm_rad, 0);
        assert!(ended.stdout.starts_with("PASS  "), "{}", ended.stdout);
    }
}
