//! The parameters of the drive: each declared once, with unit, default, range and meaning.
//!
//! The index on the wire is the index in [`TABLE`]. Defaults are table 1 of Merzouki and Cadiou.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{ControllerId, DisturbingTorqueSource, Outcome, ParameterValue};

/// Finest encoder in counts per revolution: one revolution takes the whole range of a reading.
pub const COUNTS_PER_REV_MAX: u32 = 1 << EncoderCounts::BITS;

const CONTROLLER_MAX: u32 = ControllerId::ALL.len() as u32;
const DISTURBING_TORQUE_SOURCE_MAX: u32 = DisturbingTorqueSource::ALL.len() as u32;

/// One parameter, as described to the host.
pub struct Entry {
    /// Name, with the unit at its end.
    pub name: &'static str,
    /// Unit as text; empty for a pure number.
    pub unit: &'static str,
    /// Value after power-up.
    pub default: ParameterValue,
    /// Smallest allowed value.
    pub min: ParameterValue,
    /// Largest allowed value.
    pub max: ParameterValue,
    /// Whether it may be set while armed or running.
    pub live: bool,
    get: fn(&Parameters) -> ParameterValue,
    field: fn(&mut Parameters) -> Field<'_>,
}

/// The field of a parameter in [`Parameters`].
enum Field<'a> {
    U32(&'a mut u32),
    F32(&'a mut f32),
}

impl Entry {
    /// The value in force.
    #[must_use]
    pub fn get(&self, parameters: &Parameters) -> ParameterValue {
        (self.get)(parameters)
    }

    /// Sets the value if it is of the right type and in range; otherwise nothing changes.
    pub fn set(&self, parameters: &mut Parameters, value: ParameterValue) -> Outcome {
        use ParameterValue::{F32, U32};
        // One check for all: a check per parameter would cost the image two kilobytes.
        match ((self.field)(parameters), value, self.min, self.max) {
            (Field::U32(field), U32(value), U32(min), U32(max)) => put(field, value, min, max),
            (Field::F32(field), F32(value), F32(min), F32(max)) => put(field, value, min, max),
            _ => Outcome::WrongType,
        }
    }
}

fn put<T: PartialOrd>(field: &mut T, value: T, min: T, max: T) -> Outcome {
    // NaN is in no range.
    if !(min..=max).contains(&value) {
        return Outcome::OutOfRange;
    }
    *field = value;
    Outcome::Accepted
}

macro_rules! parameters {
    ($( $(#[doc = $doc:expr])+ $name:ident: $ty:ident = $default:literal in $min:tt..=$max:tt $unit:literal $($live:ident)?; )+) => {
        /// The values in force.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Parameters { $( $(#[doc = $doc])+ pub $name: wire!($ty), )+ }

        impl Default for Parameters {
            fn default() -> Self {
                Self { $($name: $default),+ }
            }
        }

        /// Every parameter, in the order of its index on the wire.
        pub const TABLE: &[Entry] = &[$(Entry {
            name: stringify!($name),
            unit: $unit,
            default: ParameterValue::$ty($default),
            min: ParameterValue::$ty($min),
            max: ParameterValue::$ty($max),
            live: is_live!($($live)?),
            get: |parameters| ParameterValue::$ty(parameters.$name),
            field: |parameters| Field::$ty(&mut parameters.$name),
        }),+];
    };
}

macro_rules! wire {
    (U32) => {
        u32
    };
    (F32) => {
        f32
    };
}

macro_rules! is_live {
    () => {
        false
    };
    (live) => {
        true
    };
}

parameters! {
    /// Control law: a [`ControllerId`].
    controller: U32 = 1 in 1..=CONTROLLER_MAX "";
    /// Control period.
    period_us: U32 = 1000 in 100..=100_000 "us";
    /// Resolution of the motor encoder, after quadrature.
    motor_counts_per_rev: U32 = 131_072 in 4..=COUNTS_PER_REV_MAX "counts/rev";
    /// Resolution of the load encoder, after quadrature.
    load_counts_per_rev: U32 = 131_072 in 4..=COUNTS_PER_REV_MAX "counts/rev";

    /// Largest torque, either way.
    torque_limit_nm: F32 = 20.0 in 0.0..=1000.0 "N m";
    /// Longest time without a new sample while running, in device time.
    watchdog_us: U32 = 20_000 in 200..=60_000_000 "us";
    /// Largest plausible speed of the motor.
    motor_speed_limit_rad_s: F32 = 1000.0 in 0.1..=1e6 "rad/s";
    /// Largest plausible speed of the load.
    load_speed_limit_rad_s: F32 = 100.0 in 0.1..=1e6 "rad/s";
    /// Telemetry follows every n-th torque; 0 for never.
    telemetry_every: U32 = 10 in 0..=65_535 "" live;

    /// Bandwidth of the motor velocity filter.
    motor_filter_rad_s: F32 = 400.0 in 0.01..=1e6 "rad/s";
    /// Bandwidth of the load velocity filter.
    load_filter_rad_s: F32 = 200.0 in 0.01..=1e6 "rad/s";

    /// K_P1, motor position to torque.
    k_p1: F32 = 1.0 in 0.0..=1e6 "N m/rad";
    /// K_D1, motor velocity to torque.
    k_d1: F32 = 0.01 in 0.0..=1e6 "N m s/rad";
    /// K_P2, load position to motor position.
    k_p2: F32 = 10.0 in 0.0..=1e6 "";
    /// K_D2, load velocity to motor position.
    k_d2: F32 = 10.0 in 0.0..=1e6 "s";
    /// k1, elastic torque to torque.
    k_1: F32 = 1.0 in 0.0..=1e6 "";
    /// k21, load position error to the dead-zone estimate.
    k_21: F32 = 0.01 in 0.0..=1e6 "1/s";
    /// k22, elastic torque error to the dead-zone estimate.
    k_22: F32 = 0.5 in 0.0..=1e6 "1/(N m s)";
    /// Initial dead-zone estimate.
    dead_zone_initial_rad: F32 = 0.16 in 0.0..=3.0 "rad";
    /// Largest dead-zone estimate. The paper's transient passes 1.7 rad; a bound below 2 rad distorts it.
    dead_zone_max_rad: F32 = 3.0 in 0.0..=100.0 "rad";
    /// Source of the disturbing torque: a [`DisturbingTorqueSource`].
    disturbing_torque_source: U32 = 2 in 1..=DISTURBING_TORQUE_SOURCE_MAX "";
    /// Pole of the momentum observer.
    momentum_observer_rad_s: F32 = 60.0 in 0.1..=10_000.0 "rad/s";

    /// Nominal motor inertia J_m.
    motor_inertia_kg_m2: F32 = 9.72e-4 in 1e-9..=1e3 "kg m^2";
    /// Nominal viscous friction of the motor f_m.
    motor_friction_nm_s_rad: F32 = 4.3e-4 in 0.0..=1e4 "N m s/rad";
    /// Nominal Coulomb friction of the motor F_cM.
    motor_coulomb_nm: F32 = 0.0 in 0.0..=1e3 "N m";
    /// Nominal load inertia J_s.
    load_inertia_kg_m2: F32 = 7.5 in 1e-9..=1e6 "kg m^2";
    /// Nominal viscous friction of the load f_s.
    load_friction_nm_s_rad: F32 = 16.0 in 0.0..=1e6 "N m s/rad";
    /// Reduction ratio N0.
    reduction_ratio: F32 = 3.0 in 1e-3..=1e4 "";
    /// Nominal stiffness K, seen at the motor.
    stiffness_nm_rad: F32 = 1.0 in 1e-6..=1e9 "N m/rad";
    /// Nominal dead-zone amplitude j0, half the gap.
    dead_zone_rad: F32 = 0.16 in 1e-6..=10.0 "rad";

    /// Load error to wanted load velocity; this parameter and those below belong to the law `BacklashInverse`.
    approach_rate_1_s: F32 = 2.5 in 0.0..=1e6 "1/s";
    /// Largest wanted load velocity relative to the reference.
    approach_speed_rad_s: F32 = 1.5 in 0.0..=1e6 "rad/s";
    /// Load velocity error to torque at the load.
    load_velocity_gain_nm_s_rad: F32 = 30.0 in 0.0..=1e6 "N m s/rad";
    /// Integral of the load velocity error to torque at the load.
    load_integral_gain_nm_rad: F32 = 150.0 in 0.0..=1e6 "N m/rad";
    /// Largest torque of that integral, at the load.
    load_integral_limit_nm: F32 = 8.0 in 0.0..=1e6 "N m";
    /// Largest requested transmitted torque at the motor's side; never more than `torque_limit_nm`.
    transmitted_limit_nm: F32 = 8.0 in 0.0..=1e6 "N m";
    /// Transmitted torque within which the motor crosses the gap.
    gap_crossing_nm: F32 = 0.05 in 1e-6..=1e6 "N m";
    /// Twist error to torque.
    twist_gain_nm_rad: F32 = 1.0 in 0.0..=1e6 "N m/rad";
    /// Velocity of the twist to torque; at most the motor's inertia over the control period.
    twist_damping_nm_s_rad: F32 = 0.04 in 0.0..=1e6 "N m s/rad";
    /// Triple pole of the load observer; at most half of 1 over the control period.
    load_observer_rad_s: F32 = 12.0 in 0.1..=1e4 "rad/s";
    /// Smallest transmitted torque at which the gap is identified.
    identification_min_nm: F32 = 0.4 in 0.0..=1e6 "N m";
    /// Load error that counts as arrived; at least 1.05 counts of the load encoder are used.
    arrival_band_rad: F32 = 0.002 in 0.0..=1.0 "rad";
    /// Fraction of the integral kept on arrival.
    hold_fraction: F32 = 0.3 in 0.0..=1.0 "";
}
