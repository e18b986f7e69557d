//! The float type of a control law.
//!
//! A drive and its native twin must produce the same torque bit for bit. The four operations and comparisons are exact
//! by IEEE 754 on both; the transcendental functions are not, so they are taken from the `libm` crate on every
//! machine and never from a platform's own library. Products and sums are never fused.

use nalgebra::{Field, Scalar};

/// A float type the control laws can run in: `f32` in the drive, `f64` for comparison.
///
/// A field is the four operations and nothing else, so matrices of it take no function from anywhere but here.
pub trait Real: Copy + PartialOrd + Field + Scalar {
    /// Nought.
    const ZERO: Self;
    /// One.
    const ONE: Self;

    /// The nearest value of this type.
    fn from_f64(value: f64) -> Self;
    /// The value itself, or the nearest.
    fn from_f32(value: f32) -> Self;
    /// The nearest value of this type; encoder arithmetic is exact until it gets here.
    fn from_i64(value: i64) -> Self;
    /// The whole part; what doesn't fit stays at the end of the range, and NaN is nought.
    fn whole(self) -> i64;
    /// The value as an `f64`, exactly.
    fn to_f64(self) -> f64;

    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// e to the power of the value, less one, accurate near nought.
    fn exp_m1(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// The value held within `low..=high`; NaN stays NaN, for the guard behind the law to see.
    fn clamp(self, low: Self, high: Self) -> Self {
        if self < low {
            low
        } else if self > high {
            high
        } else {
            self
        }
    }

    /// Plus or minus one, and nought at nought, so that a law at rest isn't pushed to either side.
    fn sign(self) -> Self {
        if self > Self::ZERO {
            Self::ONE
        } else if self < Self::ZERO {
            -Self::ONE
        } else {
            Self::ZERO
        }
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn from_f64(value: f64) -> Self {
        value as Self
    }
    fn from_f32(value: f32) -> Self {
        value
    }
    fn from_i64(value: i64) -> Self {
        value as Self
    }
    fn whole(self) -> i64 {
        self as i64
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn tanh(self) -> Self {
        libm::tanhf(self)
    }
    fn exp_m1(self) -> Self {
        libm::expm1f(self)
    }
    fn abs(self) -> Self {
        libm::fabsf(self)
    }
    fn is_finite(self) -> bool {
        Self::is_finite(self)
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn from_f64(value: f64) -> Self {
        value
    }
    fn from_f32(value: f32) -> Self {
        Self::from(value)
    }
    fn from_i64(value: i64) -> Self {
        value as Self
    }
    fn whole(self) -> i64 {
        self as i64
    }
    fn to_f64(self) -> f64 {
        self
    }
    fn tanh(self) -> Self {
        libm::tanh(self)
    }
    fn exp_m1(self) -> Self {
        libm::expm1(self)
    }
    fn abs(self) -> Self {
        libm::fabs(self)
    }
    fn is_finite(self) -> bool {
        Self::is_finite(self)
    }
}

/// Share of the way a first-order lag of `rate` (1/s) goes towards a held input in `time` (s): `1 - e^(-rate time)`.
pub(crate) fn alpha<F: Real>(rate: F, time: F) -> F {
    -(-(rate * time)).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sign_of_nought_is_nought() {
        assert_eq!(0.0_f32.sign(), 0.0);
        assert_eq!((-0.0_f64).sign(), 0.0);
        assert_eq!((-2.5_f32).sign(), -1.0);
    }

    #[test]
    fn clamp_lets_nan_through() {
        assert!(Real::clamp(f32::NAN, -1.0, 1.0).is_nan());
        assert_eq!(Real::clamp(-3.0_f32, -1.0, 1.0), -1.0);
    }

    #[test]
    fn lag_share_keeps_its_digits_for_slow_lags_in_single_precision() {
        // 1 - e^-x loses all but three digits of 1e-5 in f32 when it is computed by subtraction.
        let share = alpha(0.01_f32, 0.001);
        assert!((share.to_f64() / 9.99995e-6 - 1.0).abs() < 2e-7, "have {share}");
    }
}
