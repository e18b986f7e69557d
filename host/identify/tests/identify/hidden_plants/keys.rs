//! What a scenario has of a hidden plant, for tests that give it to a program.

/// Keys of the plant, which are quantities of the estimates too.
pub const KEYS: [&str; 16] = [
    "motor_inertia_kg_m2",
    "motor_friction_nm_s_rad",
    "load_inertia_kg_m2",
    "load_friction_nm_s_rad",
    "stiffness_nm_rad",
    "dead_zone_rad",
    "reduction_ratio",
    "shaft_damping_nm_s_rad",
    "load_coulomb_nm",
    "load_stiction_nm",
    "load_stribeck_rad_s",
    "load_friction_asymmetry",
    "motor_coulomb_nm",
    "motor_stiction_nm",
    "motor_stribeck_rad_s",
    "current_lag_ms",
];
