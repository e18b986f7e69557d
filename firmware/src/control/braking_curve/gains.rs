//! The gains of the law, synthesised from the machine.
//!
//! Every gain is a pure number times a quantity of the machine. The motor on the shaft has the frequency w = sqrt(K / J_m), and the
//! law winds the shaft with a double pole near it:
//!
//! ```text
//! p_w = pace min(1.1 w, 0.2 / (T + lag)) * light
//! ```
//!
//! Braking curve, velocity loop, observers and the motor's loop are slower or faster than p_w by fixed factors, as far as counts of
//! the load encoder allow. Torques are fractions of the limit, inertias and friction those of the machine. A light load reaches its
//! top speed before the shaft is wound, so that winding takes most of a move: `light`, from 1 to 1.6, then makes it faster, which
//! such a load allows because little torque is needed.

use crate::control::nominal_model::NominalModel;
use crate::law::Real;

use super::tuning::BrakingCurveTuning;

/// Largest transmitted torque relative to the limit of the drive.
const TRANSMITTED: f64 = 0.95;
/// Planned deceleration relative to the possible one: plants within 30 % can follow.
const BRAKING: f64 = 0.65;
/// Speed of winding relative to w, and its largest product with period and lag.
const WINDING: f64 = 1.1;
const WINDING_LAG: f64 = 0.2;
/// The winding over the slope of the curve, and over the natural frequency of the velocity loop.
const PER_RATE: f64 = 3.9;
const PER_SPEED_LOOP: f64 = 7.2;
/// Damping of the velocity loop; least share of the gain in it where friction damps.
const DAMPING: f64 = 0.71;
const LEAST_GAIN: f64 = 0.3;
/// Largest torque at the load by which one count moves the velocity loop, relative to the largest torque.
const COUNT_TORQUE: f64 = 0.1 / 5.2;
/// Slope at the target relative to that of the curve; largest distance of the landing relative to dec / rate^2, and to the band.
const LANDING_RATE: f64 = 0.165;
const LANDING_PER_BRAKING: f64 = 0.65;
const LANDING_BANDS: f64 = 23.5;
/// Distance in bands over which a braking curve counts as long, and largest factor of a light load.
const LIGHT_BANDS: f64 = 40.0;
const LIGHTEST: f64 = 1.6;
/// Lead of the curve over the time of winding.
const LEAD: f64 = 0.8;
/// Poles of the observers relative to the winding and to the velocity loop, and that of the motor's velocity.
const SHAFT_OBSERVER: f64 = 2.05;
const SPEED_OBSERVER: f64 = 0.513 * PER_SPEED_LOOP;
const MOTOR_FILTER: f64 = 3.0;
/// Largest frequency of the motor's loop relative to 1 / (T + lag), and its damping.
const MOTOR_LOOP_LAG: f64 = 0.1;
const MOTOR_DAMPING: f64 = 1.0;
/// Largest damping relative to the one that reverses the motor's motion within a period.
const DAMPING_LIMIT: f64 = 0.8;
/// Limit of the integral relative to dry friction, and to the largest torque; its growth at standstill.
const INTEGRAL_FRICTION: f64 = 1.5;
const INTEGRAL_TORQUE: f64 = 0.02;
const REACH: f64 = 0.034;
/// Commanded speed relative to the steady one at full torque, a little beyond it so that the torque stays full, and to the motor's
/// speed limit.
const TOP_SPEED: f64 = 1.1;
const MOTOR_SPEED: f64 = 0.6;
/// Torque over which the motor crosses the gap, relative to the limit.
const CROSSING: f64 = 0.0025;
/// Velocity of the motor over which its dry friction is fed forward, relative to w U / K.
const FRICTION_TURN: f64 = 0.0033;
/// Speed over which dry friction is fed forward, relative to that of the landing, and distance relative to it.
const FRICTION_WIDTH: f64 = 0.32;
const FRICTION_FADE: f64 = 2.13;
/// Speed of standstill relative to that width.
const STANDSTILL: f64 = 0.2;
/// Load error of arrival and of release in counts, for encoders that don't resolve the band; error of release in bands.
const BAND_COUNTS: f64 = 0.55;
const RELEASE_COUNTS: f64 = 1.05;
const RELEASE_BANDS: f64 = 2.0;

/// What the law needs of the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrakingCurveSetting<F> {
    /// One count of the motor encoder in rad.
    pub motor_resolution_rad: F,
    /// One count of the load encoder in rad.
    pub load_resolution_rad: F,
    /// Torque limit of the drive in N m.
    pub torque_limit_nm: F,
    /// Speed limit of the motor in rad/s.
    pub motor_speed_limit_rad_s: F,
    /// Control period in seconds.
    pub period_s: F,
}

/// The gains, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains<F> {
    /// Planned deceleration of the load in rad/s^2.
    pub braking_rad_s2: F,
    /// Slope of the braking curve where the line takes over from the root, in 1/s.
    pub rate_1_s: F,
    /// Slope of the braking curve at the target, in 1/s.
    pub landing_rate_1_s: F,
    /// Load error in rad at which the slope begins to fall.
    pub landing_rad: F,
    /// Largest commanded load velocity in rad/s.
    pub top_speed_rad_s: F,
    /// Time in s by which the curve leads.
    pub lead_s: F,
    /// Gain of the velocity loop, at the load, in N m s/rad.
    pub speed_nm_s_rad: F,
    /// Its integral gain in N m/rad.
    pub integral_nm_rad: F,
    /// Limit of the integral in N m.
    pub integral_limit_nm: F,
    /// Growth of that limit at standstill in N m/s.
    pub reach_nm_s: F,
    /// Largest transmitted torque in N m.
    pub transmitted_nm: F,
    /// Double pole of the winding in rad/s.
    pub winding_rad_s: F,
    /// Largest speed of the motor in rad/s by winding.
    pub winding_speed_rad_s: F,
    /// Twist error to torque, in N m/rad.
    pub shaft_nm_rad: F,
    /// Velocity of the twist to torque, in N m s/rad.
    pub shaft_nm_s_rad: F,
    /// Pole of the transmitted torque's observer in rad/s.
    pub shaft_observer_rad_s: F,
    /// Triple pole of the load observer in rad/s.
    pub speed_observer_rad_s: F,
    /// Lag of the motor's velocity in its loop, in rad/s.
    pub motor_filter_rad_s: F,
    /// Transmitted torque in N m within which the motor crosses the gap.
    pub crossing_nm: F,
    /// Velocity of the motor in rad/s over which its dry friction is fed forward.
    pub friction_turn_rad_s: F,
    /// Load velocity in rad/s over which the load's dry friction is fed forward.
    pub friction_width_rad_s: F,
    /// Load error in rad below which that feed-forward fades.
    pub friction_fade_rad: F,
    /// Load velocity of standstill in rad/s.
    pub standstill_rad_s: F,
    /// Load error of arrival in rad.
    pub band_rad: F,
    /// Load error in rad that ends a hold.
    pub release_rad: F,
}

fn least<F: Real>(a: F, b: F) -> F {
    if a < b { a } else { b }
}

fn most<F: Real>(a: F, b: F) -> F {
    if a > b { a } else { b }
}

impl<F: Real> Gains<F> {
    /// The gains for a machine.
    #[must_use]
    pub fn new(
        model: &NominalModel<F>,
        tuning: &BrakingCurveTuning<F>,
        setting: &BrakingCurveSetting<F>,
    ) -> Self {
        let c = F::from_f64;
        let (period, count) = (setting.period_s, setting.load_resolution_rad);
        let (ratio, stiffness, inertia) =
            (model.reduction_ratio, model.stiffness_nm_rad, model.load_inertia_kg_m2);
        let friction = model.load_friction_nm_s_rad;
        // A drive without torque moves nothing by any gain.
        let limit = if setting.torque_limit_nm > F::ZERO { setting.torque_limit_nm } else { F::ONE };
        let motor_rad_s = (stiffness / model.motor_inertia_kg_m2).sqrt();
        let lag = period + tuning.torque_lag_s;
        let band = most(tuning.landing_band_rad, c(RELEASE_COUNTS) * count);

        let transmitted = c(TRANSMITTED) * limit;
        let driving = ratio * transmitted;
        let whole_inertia = inertia + ratio * ratio * model.motor_inertia_kg_m2;
        let braking = c(BRAKING) * driving / whole_inertia;
        let fastest = tuning.pace * c(WINDING_LAG) / lag;
        let ordinary = least(tuning.pace * c(WINDING) * motor_rad_s, fastest);
        let ordinary_rate = ordinary / c(PER_RATE);
        let light = braking / (ordinary_rate * ordinary_rate * c(LIGHT_BANDS) * band);
        let winding = least(ordinary * light.sqrt().clamp(F::ONE, c(LIGHTEST)), fastest);

        // One count of the load moves its observed velocity by about count times pole.
        let by_counts = (c(COUNT_TORQUE) * ratio * limit / (inertia * count)).sqrt();
        let speed_loop = least(winding / c(PER_SPEED_LOOP), by_counts);
        let rate = speed_loop * c(PER_SPEED_LOOP / PER_RATE);
        let damping = most(c(2.0 * DAMPING) * speed_loop * inertia, friction);
        let speed = most(damping - friction, c(LEAST_GAIN) * damping);
        let landing = least(c(LANDING_PER_BRAKING) * braking / (rate * rate), c(LANDING_BANDS) * band);
        let friction_width = c(FRICTION_WIDTH) * rate * landing;

        let steady = if friction > F::ZERO {
            c(TOP_SPEED) * most(driving - tuning.load_coulomb_nm, F::ZERO) / friction
        } else {
            tuning.top_speed_rad_s
        };
        let winding_speed = c(MOTOR_SPEED) * setting.motor_speed_limit_rad_s;
        let top_speed = least(least(tuning.top_speed_rad_s, steady), winding_speed / ratio);

        let motor_loop = c(MOTOR_LOOP_LAG) / lag;
        let shaft = least(stiffness, model.motor_inertia_kg_m2 * motor_loop * motor_loop);
        Self {
            braking_rad_s2: braking,
            rate_1_s: rate,
            landing_rate_1_s: c(LANDING_RATE) * rate,
            landing_rad: landing,
            top_speed_rad_s: top_speed,
            lead_s: c(LEAD) / winding,
            speed_nm_s_rad: speed,
            integral_nm_rad: speed_loop * (friction + speed) / c(2.0 * DAMPING),
            integral_limit_nm: c(INTEGRAL_FRICTION) * tuning.load_coulomb_nm
                + c(INTEGRAL_TORQUE) * ratio * limit,
            reach_nm_s: c(REACH) * ratio * limit * speed_loop,
            transmitted_nm: transmitted,
            winding_rad_s: winding,
            winding_speed_rad_s: winding_speed,
            shaft_nm_rad: shaft,
            shaft_nm_s_rad: least(
                c(MOTOR_DAMPING) * (shaft * model.motor_inertia_kg_m2).sqrt(),
                c(DAMPING_LIMIT) * model.motor_inertia_kg_m2 / period,
            ),
            shaft_observer_rad_s: c(SHAFT_OBSERVER) * winding,
            speed_observer_rad_s: c(SPEED_OBSERVER) * speed_loop,
            motor_filter_rad_s: c(MOTOR_FILTER) * winding,
            crossing_nm: c(CROSSING) * limit,
            friction_turn_rad_s: c(FRICTION_TURN) * motor_rad_s * limit / stiffness,
            friction_width_rad_s: friction_width,
            friction_fade_rad: c(FRICTION_FADE) * landing,
            standstill_rad_s: c(STANDSTILL) * friction_width,
            // Half a count: the decoded position is the middle of a count.
            band_rad: most(tuning.landing_band_rad - c(0.5) * count, c(BAND_COUNTS) * count),
            release_rad: c(RELEASE_BANDS) * band,
        }
    }
}
