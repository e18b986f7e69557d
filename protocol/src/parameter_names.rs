//! Names of parameters that the contract reserves: a parameter of such a name has this meaning in every drive.

/// Law in force: index of the law, a `U32` with choices. A drive with one law may omit it.
pub const CONTROLLER: &str = "controller";
/// Control period, in us.
pub const PERIOD_US: &str = "period_us";
/// Resolution of the motor encoder, in counts per revolution after quadrature.
pub const MOTOR_COUNTS_PER_REV: &str = "motor_counts_per_rev";
/// Resolution of the load encoder, in counts per revolution after quadrature.
pub const LOAD_COUNTS_PER_REV: &str = "load_counts_per_rev";
/// Longest time without a new sample while running, in us of device time.
pub const WATCHDOG_US: &str = "watchdog_us";
/// Largest torque in either direction, in N m.
pub const TORQUE_LIMIT_NM: &str = "torque_limit_nm";
/// Largest plausible speed of the motor, in rad/s.
pub const MOTOR_SPEED_LIMIT_RAD_S: &str = "motor_speed_limit_rad_s";
/// Largest plausible speed of the load, in rad/s.
pub const LOAD_SPEED_LIMIT_RAD_S: &str = "load_speed_limit_rad_s";

/// Source of the samples: `link` or `pins`, a `U32` with choices. A drive without bench mode omits it.
pub const SAMPLE_SOURCE: &str = "sample_source";
/// Control steps for each `BenchSample`. A drive without bench mode omits it.
pub const BENCH_SAMPLE_EVERY: &str = "bench_sample_every";

/// Names that every drive must have: every run or a safety rule depends on them.
pub const REQUIRED: [&str; 7] = [
    PERIOD_US,
    MOTOR_COUNTS_PER_REV,
    LOAD_COUNTS_PER_REV,
    WATCHDOG_US,
    TORQUE_LIMIT_NM,
    MOTOR_SPEED_LIMIT_RAD_S,
    LOAD_SPEED_LIMIT_RAD_S,
];

/// Every reserved name: [`CONTROLLER`], then those of [`REQUIRED`].
pub const RESERVED: [&str; 8] = {
    let [period, motor_counts, load_counts, watchdog, torque_limit, motor_limit, load_limit] = REQUIRED;
    [CONTROLLER, period, motor_counts, load_counts, watchdog, torque_limit, motor_limit, load_limit]
};
