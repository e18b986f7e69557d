//! The paper's scenarios, compiled in, so that no program needs their files.

/// File name and text of a scenario.
pub type Source = (&'static str, &'static str);

/// Smooth plant before and after compensation, then plant with friction before and after.
pub const SCENARIOS: [Source; 4] = [
    ("scenarios/smooth-before.toml", include_str!("../../../scenarios/smooth-before.toml")),
    ("scenarios/smooth-after.toml", include_str!("../../../scenarios/smooth-after.toml")),
    ("scenarios/friction-before.toml", include_str!("../../../scenarios/friction-before.toml")),
    ("scenarios/friction-after.toml", include_str!("../../../scenarios/friction-after.toml")),
];

/// The same plants and laws in bench mode.
pub const BENCH_SCENARIOS: [Source; 4] = [
    ("scenarios/bench-smooth-before.toml", include_str!("../../../scenarios/bench-smooth-before.toml")),
    ("scenarios/bench-smooth-after.toml", include_str!("../../../scenarios/bench-smooth-after.toml")),
    ("scenarios/bench-friction-before.toml", include_str!("../../../scenarios/bench-friction-before.toml")),
    ("scenarios/bench-friction-after.toml", include_str!("../../../scenarios/bench-friction-after.toml")),
];
