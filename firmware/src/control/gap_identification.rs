//! Compliance and half gap of the transmission, by recursive least squares.
//!
//! In contact on either flank z = kappa (C + o + f v) + j sgn C, with kappa = 1 / K, the observed torque C, the unknown offset o of
//! the motor's torque, and a torque f v that grows with the motor's speed v. Twist and torque are both measured at the motor's side, so neither contains the friction on the load, which
//! biases the paper's estimate. One flank can't tell j from kappa o: only both flanks separate them. The deviation of j says so,
//! because o and f are unknowns with stated deviations.
//!
//! A sample counts if torque and twist have one sign, the torque is large enough for contact to be certain, and motor and twist are
//! slow, but not at rest: while they accelerate, every delay between torque and position looks like a piece of gap, and at rest the
//! motor's friction has any direction.
//!
//! All unknowns are relative to the machine: torques to its limit U, angles to U / K, times to the period of the motor on the
//! shaft, 1 / w with w = sqrt(K / J_m). So the constants below hold for a machine of any size.

use nalgebra::{Matrix4, Vector4};

use crate::law::Real;

/// Variance of a sample of unit time, from the errors of observer and plant; errors of neighbouring samples are correlated.
/// Fitted on random plants, so that 95 % of the estimates are within two deviations.
const SAMPLE_VARIANCE: f64 = 2.3e-6;
/// The same for each unit of the variance of the encoders' counts.
const COUNT_VARIANCE: f64 = 0.064;
/// Growth of a sample's variance with the square of its torque: errors of scale and speed grow with torque.
const TORQUE_VARIANCE: f64 = 30.0;
/// Variance of the nominal compliance.
const COMPLIANCE_VARIANCE: f64 = 0.09;
/// Deviation of the initial half gap relative to its value, and the least one.
const INITIAL_DEVIATION: f64 = 1.9;
const LEAST_INITIAL_DEVIATION: f64 = 0.015;
/// Growth of the half gap's variance in a unit of time, up to the initial variance. The estimate follows wear within some ten
/// seconds of contact.
const DRIFT: f64 = 1.1e-10;
/// Range of the compliance relative to the nominal one.
const COMPLIANCE_RANGE: (f64, f64) = (0.5, 2.0);
/// Smallest torque at which a sample counts, besides [`CERTAIN_DEVIATIONS`] of the offset.
const LEAST_TORQUE: f64 = 0.012;
const CERTAIN_DEVIATIONS: f64 = 2.0;
/// Largest rate of the twist at which a sample counts.
const FASTEST_TWIST: f64 = 0.005;
/// Torque of the motor's acceleration, and rate of the twist, up to which the motor is balanced, and the periods in a row before a
/// sample counts: otherwise the lag of the observer turns acceleration into a piece of gap.
const BALANCE: f64 = 0.03;
const BALANCED_TWIST: f64 = 0.0066;
const BALANCED_PERIODS: u32 = 19;
/// Fraction of the motor's dry friction, and motor velocity relative to [`BALANCED_TWIST`], from which its direction is certain.
const CERTAIN_FRICTION: f64 = 0.99;
const MOVING_MOTOR: f64 = 0.02;
/// Fraction of a sample's misfit in the mean of the last ones, and the misfit's weight in the deviation.
const MISFIT_FRACTION: f64 = 0.01;
const MISFIT_WEIGHT: f64 = 0.27;
/// Fraction of the motor's Coulomb friction that counts as unknown.
const FRICTION_UNKNOWN: f64 = 0.3;

/// What the identification needs to know of the machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct Machine<F> {
    /// Nominal stiffness K in N m/rad.
    pub(in crate::control) stiffness_nm_rad: F,
    /// Inertia of the motor in kg m^2.
    pub(in crate::control) motor_inertia_kg_m2: F,
    /// Coulomb friction of the motor in N m.
    pub(in crate::control) motor_coulomb_nm: F,
    /// Torque limit in N m.
    pub(in crate::control) torque_limit_nm: F,
    /// Standard deviation of the torque's offset, relative to the limit.
    pub(in crate::control) offset_deviation: F,
    /// Standard deviation of the torque that repeats in every move, relative to the limit.
    pub(in crate::control) ripple_deviation: F,
    /// Standard deviation of the torque that grows with the motor's speed, at the speed limit and relative to the torque limit.
    pub(in crate::control) speed_deviation: F,
    /// Speed limit of the motor in rad/s.
    pub(in crate::control) speed_limit_rad_s: F,
    /// One count of the motor encoder, in rad of twist.
    pub(in crate::control) motor_count_rad: F,
    /// One count of the load encoder, in rad of twist.
    pub(in crate::control) load_count_rad: F,
    /// Half gap at the start in rad.
    pub(in crate::control) initial_rad: F,
    /// Largest half gap in rad.
    pub(in crate::control) max_rad: F,
    /// Control period in s.
    pub(in crate::control) period_s: F,
}

/// Prior values and bounds, relative to the machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct Identification<F> {
    /// U, U / K, and their quotients.
    per_torque_1_nm: F,
    twist_rad: F,
    per_twist_1_rad: F,
    nominal_rad_nm: F,
    sample_variance: F,
    drift: F,
    initial: F,
    initial_variance: F,
    max: F,
    offset_variance: F,
    speed_variance: F,
    per_speed_s_rad: F,
    /// Variance that contacts don't reduce: counts, and the repeating torques for a compliance of 1.
    count_variance: F,
    torque_variance: F,
    fastest_twist_rad_s: F,
    balance_nm: F,
    balanced_twist_rad_s: F,
    moving_motor_rad_s: F,
}

/// The motor and the shaft at one sample, all behind the lag of the observer of the transmitted torque but the last two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct ShaftSample<F> {
    /// Observed transmitted torque in N m.
    pub(in crate::control) transmitted_nm: F,
    /// Torque in N m that accelerates the motor.
    pub(in crate::control) accelerating_nm: F,
    /// Twist in rad and its rate in rad/s.
    pub(in crate::control) twist_rad: F,
    /// Rate of the twist in rad/s.
    pub(in crate::control) twist_rate_rad_s: F,
    /// Velocity of the motor in rad/s.
    pub(in crate::control) motor_velocity_rad_s: F,
    /// Fraction of the motor's dry friction, -1 to 1.
    pub(in crate::control) friction: F,
}

/// The estimates and their covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct Estimate<F: Real> {
    /// Compliance, half gap, twist by the offset, twist by the torque that grows with speed.
    parameters: Vector4<F>,
    covariance: Matrix4<F>,
    misfit: F,
    balanced_periods: u32,
}

/// What the identification knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::control) struct Gap<F> {
    /// Compliance kappa in rad/(N m).
    pub(in crate::control) compliance_rad_nm: F,
    /// Half gap j_hat in rad.
    pub(in crate::control) dead_zone_rad: F,
}

impl<F: Real> Identification<F> {
    /// The identification for a machine.
    pub(in crate::control) fn new(machine: &Machine<F>) -> Self {
        let square = |value: F| value * value;
        let limit = machine.torque_limit_nm;
        // A drive without torque learns nothing; its unit is then arbitrary.
        let unit_nm = if limit > F::ZERO { limit } else { F::ONE };
        let twist_rad = unit_nm / machine.stiffness_nm_rad;
        let rate = (machine.stiffness_nm_rad / machine.motor_inertia_kg_m2).sqrt();
        let per_twist = F::ONE / twist_rad;
        let counts = square(machine.motor_count_rad * per_twist) + square(machine.load_count_rad * per_twist);
        let period = rate * machine.period_s;
        let initial = machine.initial_rad * per_twist;
        let deviation = F::from_f64(INITIAL_DEVIATION) * initial;
        let least = F::from_f64(LEAST_INITIAL_DEVIATION);
        let initial_deviation = if deviation > least { deviation } else { least };
        let friction = F::from_f64(FRICTION_UNKNOWN) * machine.motor_coulomb_nm / unit_nm;
        Self {
            per_torque_1_nm: F::ONE / unit_nm,
            twist_rad,
            per_twist_1_rad: per_twist,
            nominal_rad_nm: F::ONE / machine.stiffness_nm_rad,
            sample_variance: (F::from_f64(SAMPLE_VARIANCE) + F::from_f64(COUNT_VARIANCE) * counts) / period,
            drift: F::from_f64(DRIFT) * period,
            initial,
            initial_variance: square(initial_deviation),
            max: machine.max_rad * per_twist,
            offset_variance: square(machine.offset_deviation),
            speed_variance: square(machine.speed_deviation),
            per_speed_s_rad: if machine.speed_limit_rad_s > F::ZERO {
                F::ONE / machine.speed_limit_rad_s
            } else {
                F::ZERO
            },
            count_variance: F::from_f64(0.25) * counts,
            torque_variance: square(machine.ripple_deviation) + square(friction),
            fastest_twist_rad_s: F::from_f64(FASTEST_TWIST) * rate * twist_rad,
            balance_nm: F::from_f64(BALANCE) * unit_nm,
            balanced_twist_rad_s: F::from_f64(BALANCED_TWIST) * rate * twist_rad,
            moving_motor_rad_s: F::from_f64(MOVING_MOTOR * BALANCED_TWIST) * rate * twist_rad,
        }
    }

    /// The prior values.
    pub(in crate::control) fn initial_estimate(&self) -> Estimate<F> {
        let variances = Vector4::new(
            F::from_f64(COMPLIANCE_VARIANCE),
            self.initial_variance,
            self.offset_variance,
            self.speed_variance,
        );
        Estimate {
            parameters: Vector4::new(F::ONE, self.initial, F::ZERO, F::ZERO),
            covariance: Matrix4::from_diagonal(&variances),
            misfit: F::ZERO,
            balanced_periods: 0,
        }
    }

    /// Updates the estimate by one sample, if the sample counts and the law doesn't hold.
    // Two laws step it: out of line, the call costs each of them some ten instructions.
    #[inline(always)]
    pub(in crate::control) fn step(&self, estimate: &mut Estimate<F>, sample: &ShaftSample<F>, holds: bool) {
        let rate = sample.twist_rate_rad_s.abs();
        let balanced = sample.accelerating_nm.abs() < self.balance_nm && rate < self.balanced_twist_rad_s;
        estimate.balanced_periods =
            if balanced { (estimate.balanced_periods + 1).min(BALANCED_PERIODS) } else { 0 };
        // A motor at rest, or about to turn back, has a friction of unknown direction.
        let turns = sample.friction.abs() > F::from_f64(CERTAIN_FRICTION)
            && sample.motor_velocity_rad_s.abs() > self.moving_motor_rad_s;
        let in_contact = sample.transmitted_nm * sample.twist_rad > F::ZERO;
        if holds || !turns || !in_contact || estimate.balanced_periods < BALANCED_PERIODS {
            return;
        }
        let torque = self.per_torque_1_nm * sample.transmitted_nm;
        // Beyond the least torque by so many deviations of the offset, without the microcontroller's slow square root.
        let beyond = (torque.abs() - F::from_f64(LEAST_TORQUE)) * estimate.parameters.x;
        let speed = self.per_speed_s_rad * sample.motor_velocity_rad_s;
        let unknown = estimate.covariance.m33 + speed * speed * estimate.covariance.m44;
        let square = F::from_f64(CERTAIN_DEVIATIONS * CERTAIN_DEVIATIONS) * unknown;
        if beyond > F::ZERO && beyond * beyond > square && rate < self.fastest_twist_rad_s {
            self.update(estimate, torque, speed, self.per_twist_1_rad * sample.twist_rad);
        }
    }

    fn update(&self, estimate: &mut Estimate<F>, torque: F, speed: F, twist: F) {
        // Element by element: the library's generic product takes three times the instructions on the microcontroller.
        let side = torque.sign();
        let p = &mut estimate.covariance;
        let spread = [
            p.m11 * torque + p.m12 * side + p.m13 + p.m14 * speed,
            p.m21 * torque + p.m22 * side + p.m23 + p.m24 * speed,
            p.m31 * torque + p.m32 * side + p.m33 + p.m34 * speed,
            p.m41 * torque + p.m42 * side + p.m43 + p.m44 * speed,
        ];
        let variance = self.sample_variance * (F::ONE + F::from_f64(TORQUE_VARIANCE) * torque * torque);
        let innovation = variance + (torque * spread[0] + side * spread[1] + spread[2] + speed * spread[3]);
        let gain = spread.map(|element| element / innovation);
        p.m11 -= gain[0] * spread[0];
        p.m12 -= gain[0] * spread[1];
        p.m13 -= gain[0] * spread[2];
        p.m14 -= gain[0] * spread[3];
        p.m21 -= gain[1] * spread[0];
        p.m22 -= gain[1] * spread[1];
        p.m23 -= gain[1] * spread[2];
        p.m24 -= gain[1] * spread[3];
        p.m31 -= gain[2] * spread[0];
        p.m32 -= gain[2] * spread[1];
        p.m33 -= gain[2] * spread[2];
        p.m34 -= gain[2] * spread[3];
        p.m41 -= gain[3] * spread[0];
        p.m42 -= gain[3] * spread[1];
        p.m43 -= gain[3] * spread[2];
        p.m44 -= gain[3] * spread[3];
        let x = &mut estimate.parameters;
        let error = twist - (x.x * torque + x.y * side + x.z + x.w * speed);
        estimate.misfit += F::from_f64(MISFIT_FRACTION) * (error.abs() - estimate.misfit);
        x.x += gain[0] * error;
        x.y += gain[1] * error;
        x.z += gain[2] * error;
        x.w += gain[3] * error;
        if estimate.covariance.m22 < self.initial_variance {
            estimate.covariance.m22 += self.drift;
        }
        // Rounding must not make a variance negative.
        if estimate.covariance.m33 < F::ZERO {
            estimate.covariance.m33 = F::ZERO;
        }
        if estimate.covariance.m44 < F::ZERO {
            estimate.covariance.m44 = F::ZERO;
        }
        // A compliance beyond its range is moved to the end of it, and gap and offset with it, as their covariance says: the
        // samples that moved it then still agree with them.
        let (low, high) = COMPLIANCE_RANGE;
        let compliance = estimate.parameters.x.clamp(F::from_f64(low), F::from_f64(high));
        if compliance != estimate.parameters.x && estimate.covariance.m11 > F::ZERO {
            let moved = (compliance - estimate.parameters.x) / estimate.covariance.m11;
            estimate.parameters.x = compliance;
            estimate.parameters.y += estimate.covariance.m21 * moved;
            estimate.parameters.z += estimate.covariance.m31 * moved;
            estimate.parameters.w += estimate.covariance.m41 * moved;
        }
        estimate.parameters.y = estimate.parameters.y.clamp(F::ZERO, self.max);
    }

    /// Compliance and half gap.
    pub(in crate::control) fn gap(&self, estimate: &Estimate<F>) -> Gap<F> {
        Gap {
            compliance_rad_nm: self.nominal_rad_nm * estimate.parameters.x,
            dead_zone_rad: self.twist_rad * estimate.parameters.y,
        }
    }

    /// Standard deviation of j_hat in rad: that of the regression, with the unknown offset of the torque, and what no number of
    /// equal contacts reduces: counts, ripple and friction of the motor, and the misfit of samples that contradict the model.
    pub(in crate::control) fn dead_zone_deviation_rad(&self, estimate: &Estimate<F>) -> F {
        let compliance = estimate.parameters.x;
        let misfit = F::from_f64(MISFIT_WEIGHT) * estimate.misfit;
        let variance = estimate.covariance.m22
            + self.count_variance
            + compliance * compliance * self.torque_variance
            + misfit * misfit;
        self.twist_rad * variance.sqrt()
    }
}

#[cfg(test)]
mod tests;
