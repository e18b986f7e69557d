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

/// Every reserved name.
pub const RESERVED: [&str; 5] =
    [CONTROLLER, PERIOD_US, MOTOR_COUNTS_PER_REV, LOAD_COUNTS_PER_REV, WATCHDOG_US];
