//! The paper's scenarios, compiled in, so that no program needs their files.

/// File name and text of a scenario.
pub type Source = (&'static str, &'static str);

/// Smooth plant before and after compensation, then plant with friction before and after.
pub const SCENARIOS: [Source; 4] = [
    ("scenarios/smooth-before.toml", include_str!("../data/smooth-before.toml")),
    ("scenarios/smooth-after.toml", include_str!("../data/smooth-after.toml")),
    ("scenarios/friction-before.toml", include_str!("../data/friction-before.toml")),
    ("scenarios/friction-after.toml", include_str!("../data/friction-after.toml")),
];

/// The same plants and laws in bench mode.
pub const BENCH_SCENARIOS: [Source; 4] = [
    ("scenarios/bench-smooth-before.toml", include_str!("../data/bench-smooth-before.toml")),
    ("scenarios/bench-smooth-after.toml", include_str!("../data/bench-smooth-after.toml")),
    ("scenarios/bench-friction-before.toml", include_str!("../data/bench-friction-before.toml")),
    ("scenarios/bench-friction-after.toml", include_str!("../data/bench-friction-after.toml")),
];

/// What puts a motor on a bridge with a current loop between drive and plant, as settings of [`BENCH_SCENARIOS`]: 26 N m at
/// 110 A, and a sensor that is off by 2 %.
pub const BRIDGE: [&str; 20] = [
    "plant.electrical.torque_source=current",
    "plant.electrical.resistance_ohm=0.96",
    "plant.electrical.inductance_h=1e-3",
    "plant.electrical.torque_constant_nm_a=0.24",
    "plant.electrical.supply_v=120",
    "plant.electrical.sense_range_a=200",
    "plant.electrical.sense_offset_a=4",
    "plant.electrical.sense_noise_a=0.1",
    "bench.stage_mode=complementary",
    "bench.duty_min=0",
    "bench.duty_max=1",
    "bench.torque_source=current",
    "bench.motor_resistance_ohm=0.96",
    "bench.motor_inductance_h=1e-3",
    "bench.torque_constant_nm_a=0.24",
    "bench.current_range_a=200",
    "bench.current_limit_a=110",
    "bench.supply_range_v=200",
    "bench.supply_v=120",
    "bench.supply_max_v=180",
];
