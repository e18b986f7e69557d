//! Commissioning of a brushed motor at a bridge with a current sensor, on virtual silicon.
//!
//! The drive states R, L and k_t that are 30 % off. The sensor has an offset of 2 % of its range, and noise.

use std::fs;

use tests::program::{self, Ended};
use tests::records::Records;

/// The motor, its supply and the sensor.
const TRUTHS: [(&str, f64, f64); 3] = [
    // Name, truth, and largest error as a part.
    ("motor_resistance_ohm", 0.384, 0.05),
    ("motor_inductance_h", 4e-4, 0.15),
    ("torque_constant_nm_a", 0.24, 0.05),
];
const MOTOR: [&str; 10] = [
    "plant.current_lag_ms=0",
    "plant.torque_saturation_nm=100",
    "plant.electrical.torque_source=current",
    "plant.electrical.resistance_ohm=0.384",
    "plant.electrical.inductance_h=4e-4",
    "plant.electrical.torque_constant_nm_a=0.24",
    "plant.electrical.supply_v=48",
    "plant.electrical.sense_range_a=125",
    "plant.electrical.sense_offset_a=2.5",
    "plant.electrical.sense_noise_a=0.1",
];
const DRIVE: [&str; 13] = [
    "bench.stage_mode=complementary",
    "bench.duty_min=0",
    "bench.duty_max=1",
    "bench.twist_limit_rad=40",
    "bench.torque_source=current",
    "bench.current_range_a=125",
    "bench.current_limit_a=70",
    "bench.supply_range_v=60",
    "bench.supply_v=48",
    "bench.motor_resistance_ohm=0.5",
    "bench.motor_inductance_h=3e-4",
    "bench.torque_constant_nm_a=0.3",
    "bench.motor_direction=forward",
];

fn commission(records: &Records, more: &[&str]) -> Ended {
    let out = records.out();
    let limits = ["--torque-limit", "12", "--motor-speed-limit", "800", "--load-speed-limit", "10"];
    let fixed = ["commission", "--device", "silicon", "--mode", "bench", "--yes", "--travel-limit", "0.4"];
    let settings = MOTOR.iter().chain(&DRIVE).chain(more).flat_map(|setting| ["--set", *setting]);
    program::run(fixed.into_iter().chain(limits).chain(["--only-electrical", "--out", &out]).chain(settings))
}

/// Value and interval of each line of the file, `NAME = VALUE # LOW to HIGH UNIT`.
fn estimate(text: &str, name: &str) -> [f64; 3] {
    let line = text.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{name}: {text}"));
    let words: Vec<_> = line.split_whitespace().collect();
    [2, 4, 6].map(|at| words[at].parse().unwrap_or_else(|error| panic!("{error}: {line}")))
}

pub(crate) fn found() {
    let records = Records::new();
    let _ = commission(&records, &[]).with_code(0);
    let text = fs::read_to_string(records.path("motor.toml")).expect("the motor");
    for (name, truth, largest) in TRUTHS {
        let [value, low, high] = estimate(&text, name);
        assert!((low..=high).contains(&truth), "{name}: {text}");
        assert!((value / truth - 1.0).abs() < largest, "{name}: {text}");
    }
}

pub(crate) fn reversed() {
    let records = Records::new();
    let ended = commission(&records, &["bench.current_direction=reverse"]).with_code(3);
    assert!(ended.stderr.contains("current_direction"), "{}", ended.stderr);
    let made: Vec<_> = ended.stdout.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(made, ["electrical-polarity-1"], "{}", ended.stdout);
}

pub(crate) fn wrong_scale() {
    let records = Records::new();
    let ended = commission(&records, &["bench.current_range_a=250"]).with_code(3);
    assert!(ended.stderr.contains("correct current_range_a"), "{}", ended.stderr);
    assert!(!ended.stdout.contains("breakaway"), "{}", ended.stdout);
    assert!(!records.path("motor.toml").exists());
}
