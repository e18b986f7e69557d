//! What the specimen consists of: two laws, sixteen signals, twelve parameters in an order of its own.

use lashloop_protocol::enums::{ParameterFlags, ParameterValue};

use ParameterValue::{F32, U32};

pub const LAWS: [&str; 2] = ["spring", "spring-integral"];
const ALL: u16 = 0b11;
const SPRING: u16 = 0b01;
const INTEGRAL: u16 = 0b10;

/// Name, unit and laws of every signal. The first law lacks one, so that it still has more than a telemetry holds.
pub const SIGNALS: [(&str, &str, u16); 16] = [
    ("load_position_rad", "rad", ALL),
    ("motor_position_rad", "rad", ALL),
    ("requested_torque_nm", "N m", ALL),
    ("integral_nm", "N m", INTEGRAL),
    ("load_velocity_rad_s", "rad/s", ALL),
    ("motor_velocity_rad_s", "rad/s", ALL),
    ("load_error_rad", "rad", ALL),
    ("spring_torque_nm", "N m", ALL),
    ("damping_torque_nm", "N m", ALL),
    ("reference_rad", "rad", ALL),
    ("twist_rad", "rad", ALL),
    ("elapsed_periods", "", ALL),
    ("steps", "", ALL),
    ("pure_spring_nm", "N m", SPRING),
    ("load_turns", "", ALL),
    ("motor_turns", "", ALL),
];

#[derive(Clone, Copy, PartialEq)]
pub struct Parameter {
    pub name: &'static str,
    pub unit: &'static str,
    pub flags: ParameterFlags,
    pub laws: u16,
    pub default: ParameterValue,
    pub min: ParameterValue,
    pub max: ParameterValue,
}

const fn of(name: &'static str, unit: &'static str, [default, min, max]: [ParameterValue; 3]) -> Parameter {
    Parameter { name, unit, flags: ParameterFlags::empty(), laws: ALL, default, min, max }
}

pub const TORQUE_LIMIT: usize = 0;
pub const WATCHDOG: usize = 1;
pub const PERIOD: usize = 2;
/// Motor and load.
pub const COUNTS: [usize; 2] = [4, 3];
pub const SPEED_LIMITS: [usize; 2] = [5, 6];
pub const GAIN: usize = 7;
pub const CONTROLLER: usize = 8;
pub const DAMPING: usize = 9;
pub const INTEGRAL_GAIN: usize = 10;
pub const OUTPUT: usize = 11;

pub const PARAMETER_COUNT: usize = 12;

/// The parameters of a drive.
pub type Table = [Parameter; PARAMETER_COUNT];

pub static PARAMETERS: Table = TABLE;

const TABLE: Table = [
    of("torque_limit_nm", "N m", [F32(20.0), F32(0.0), F32(1e3)]),
    of("watchdog_us", "us", [U32(20_000), U32(200), U32(60_000_000)]),
    of("period_us", "us", [U32(1_000), U32(100), U32(100_000)]),
    of("load_counts_per_rev", "counts/rev", [U32(16_384), U32(4), U32(1 << 24)]),
    of("motor_counts_per_rev", "counts/rev", [U32(65_536), U32(4), U32(1 << 24)]),
    of("motor_speed_limit_rad_s", "rad/s", [F32(1e3), F32(0.1), F32(1e6)]),
    of("load_speed_limit_rad_s", "rad/s", [F32(100.0), F32(0.1), F32(1e6)]),
    Parameter { flags: ParameterFlags::LIVE, ..of("gain_nm_rad", "N m/rad", [F32(2.0), F32(0.0), F32(1e6)]) },
    Parameter { flags: ParameterFlags::CHOICES, ..of("controller", "", [U32(0), U32(0), U32(1)]) },
    of("damping_nm_s_rad", "N m s/rad", [F32(0.01), F32(0.0), F32(1e3)]),
    Parameter { laws: INTEGRAL, ..of("integral_gain_1_s", "1/s", [F32(0.5), F32(0.0), F32(1e3)]) },
    Parameter { flags: ParameterFlags::CHOICES, ..of("output", "", [U32(1), U32(1), U32(3)]) },
];

const fn with<const N: usize>(changes: [(usize, [ParameterValue; 3]); N]) -> Table {
    let mut table = TABLE;
    let mut at = 0;
    while at < N {
        let (index, [default, min, max]) = changes[at];
        (table[index].default, table[index].min, table[index].max) = (default, min, max);
        at += 1;
    }
    table
}

/// With fine encoders: the longest gap is 50 periods for the motor.
pub static FINE: Table = {
    let fine = [U32(1 << 20), U32(4), U32(1 << 24)];
    with([(COUNTS[0], fine), (COUNTS[1], fine)])
};

/// With one timer and absolute encoders: one period and one resolution each.
pub static FIXED: Table =
    with([(PERIOD, [U32(500); 3]), (COUNTS[0], [U32(131_072); 3]), (COUNTS[1], [U32(65_536); 3])]);

/// With a load so slow that no settings leave its position ambiguous.
pub static SLOW: Table = with([(SPEED_LIMITS[1], [F32(100.0), F32(0.1), F32(200.0)])]);

/// With real numbers where the page allows them.
pub static REAL: Table = {
    let counts = [F32(65_536.0), F32(4.0), F32(16_777_216.0)];
    let period = [F32(1_000.0), F32(100.0), F32(100_000.0)];
    let watchdog = [F32(20_000.0), F32(200.0), F32(60_000_000.0)];
    with([(PERIOD, period), (COUNTS[0], counts), (COUNTS[1], counts), (WATCHDOG, watchdog)])
};

/// Names of the values of `output`, from its `min`.
pub const OUTPUTS: [&str; 3] = ["direct", "half", "double"];
