//! A machine that is commissioned, told to the law, and moved; margins of any scenario.

use tests::program;
use tests::records::Records;

/// Plant and encoders that differ from everything that the program has as a default, with a torque that is off.
const MACHINE: [&str; 12] = [
    "plant.motor_inertia_kg_m2=1.3e-3",
    "plant.load_inertia_kg_m2=3.0",
    "plant.stiffness_nm_rad=1.4",
    "plant.dead_zone_rad=0.09",
    "plant.reduction_ratio=4.0",
    "plant.current_lag_ms=1.5",
    "plant.torque_offset_nm=0.1",
    "plant.cogging_nm=0.05",
    "plant.cogging_per_turn=7",
    "plant.initial.motor_position_rad=0.19",
    "encoders.motor_counts_per_rev=8192",
    "encoders.load_counts_per_rev=16384",
];

fn margin(stdout: &str, key: &str) -> String {
    let line = stdout.lines().find_map(|line| line.strip_prefix("margin ")?.trim_start().strip_prefix(key));
    line.unwrap_or_else(|| panic!("no margin of {key}: {stdout}")).trim().to_owned()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split([' ', '+']).filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn a_commissioned_machine_makes_the_reach_that_is_expected_of_it() {
    let records = Records::new();
    let out = records.out();
    let fixed = ["commission", "--device", "inproc", "--yes", "--out", &out, "--torque-limit", "20"];
    let limits = ["--motor-speed-limit", "400", "--load-speed-limit", "10", "--travel-limit", "1.5"];
    let machine = MACHINE.iter().flat_map(|setting| ["--set", setting]);
    let ended = program::run(fixed.into_iter().chain(limits).chain(machine)).with_code(0);
    assert!(ended.stdout.contains("first reach          0.75 rad with braking-curve"), "{}", ended.stdout);
    let delay_ms = numbers(&margin(&ended.stdout, "torque_delay_us"));
    assert!(delay_ms[0] > 3.0, "{}", ended.stdout);

    let parameters =
        std::fs::read_to_string(records.path("drive.toml")).expect("the parameters of the drive");
    let parameter = |name: &str| -> f64 {
        let value = parameters.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
        let value = value.unwrap_or_else(|| panic!("no {name}: {parameters}"));
        value.split(' ').next().and_then(|it| it.parse().ok()).expect("a number")
    };
    for (name, truth, within) in [
        ("torque_offset_nm", 0.1, 1e-3),
        ("cogging_nm", 0.05, 1e-3),
        ("cogging_per_turn", 7.0, 0.0),
        ("cogging_phase_rad", 0.0, 0.1),
        ("torque_lag_s", 0.0025, 1e-4),
    ] {
        let have = parameter(name);
        assert!((have - truth).abs() <= within, "{name} {have}, want {truth}");
    }
    // What is left of the torque is less than a hundredth of what a law assumes by default.
    assert!(parameter("torque_offset_deviation") < 6e-5, "{parameters}");
    assert!(parameter("torque_ripple_deviation") < 1e-5, "{parameters}");

    // The file has the machine itself. The reach confirms the estimates, and then the load moves to and fro.
    let reach = records.path("reach.toml");
    let reach = reach.to_str().expect("UTF-8");
    let _ = program::run(["run", reach, "--device", "inproc"]).with_code(0);
    let moves = tests::workspace().join("scenarios/alternating-moves.csv");
    let moves =
        format!("reference={{ profile = 'table', file = '{}', interpolation = 'hold' }}", moves.display());
    let to_and_fro = Records::new();
    let out = to_and_fro.out();
    let more = ["--set", &moves, "--set", "run.duration_s=30", "--set", "expect=[]", "--out", &out];
    let _ = program::run([&["run", reach, "--device", "inproc"], &more[..]].concat());
    let summary = to_and_fro.summary();
    let metric = |name: &str| summary["metrics"][name].as_f64().unwrap_or(f64::NAN);
    let (error_rad, deviation_rad) = (metric("dead_zone_error_rad"), metric("dead_zone_deviation_rad"));
    assert!(
        deviation_rad < 0.012 && error_rad.abs() < 2.0 * deviation_rad,
        "{error_rad} rad, {deviation_rad} rad"
    );
}

#[test]
fn a_law_that_is_told_of_a_lag_tolerates_more_delay_and_a_load_that_never_rests_has_no_margins() {
    let of = |lag: &str| {
        let set = format!("controller.parameters.torque_lag_s={lag}");
        let ended =
            program::run(["margins", "scenarios/shaft-braking-curve.toml", "--set", &set]).with_code(0);
        let inertia = numbers(&margin(&ended.stdout, "load_inertia_kg_m2"));
        assert!(inertia[0] < 1.0 && inertia[1] > 1.3, "{}", ended.stdout);
        numbers(&margin(&ended.stdout, "torque_delay_us"))[0]
    };
    let (untold_ms, told_ms) = (of("0.0015"), of("0.015"));
    assert!(told_ms > 1.5 * untold_ms && untold_ms > 5.0, "{untold_ms} ms, {told_ms} ms");
    let ended = program::run(["margins", "scenarios/shaft-pd.toml"]).with_code(1);
    assert!(ended.stdout.contains("the load doesn't settle"), "{}", ended.stdout);
    assert!(!ended.stdout.contains("\nmargin"), "{}", ended.stdout);
}

#[test]
fn margins_are_those_of_quantities_that_the_plant_has_and_of_one_move() {
    let ended = program::run(["margins", "scenarios/friction-after.toml"]).with_code(0);
    assert!(!ended.stdout.contains("torque_delay_us"), "{}", ended.stdout);
    let of_rad = numbers(&margin(&ended.stdout, "load_inertia_kg_m2"));
    assert!(of_rad[0] < 1.0 && of_rad[1] > 1.0, "{}", ended.stdout);
    let ended = program::run(["margins", "scenarios/shaft-sine.toml"]).with_code(2);
    assert!(ended.stderr.contains("its reference isn't constant"), "{}", ended.stderr);
    let slow = [
        "margins",
        "scenarios/shaft-braking-curve.toml",
        "--set",
        "controller.parameters.load_speed_limit_rad_s=1",
    ];
    let ended = program::run(slow).with_code(1);
    assert!(ended.stdout.contains("Overspeed") || ended.stdout.contains("latched"), "{}", ended.stdout);
}
