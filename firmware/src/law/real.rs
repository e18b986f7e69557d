//! The float type of a control law.
//!
//! The same drive on any machine must give the same torque bit for bit. IEEE 754 defines the four operations and the
//! comparisons exactly, but not the transcendental functions: they come from the `libm` crate on every machine, never
//! from a platform's library. Products and sums are never fused.

use nalgebra::{Field, Scalar};

/// A float type the control laws can run in: `f32` in the drive, `f64` for comparison.
///
/// A field has the four operations only, so matrices of it take every other function from here.
pub trait Real: Copy + PartialOrd + Field + Scalar {
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;

    /// The nearest value of this type.
    fn from_f64(value: f64) -> Self;
    /// The nearest value of this type. Encoder arithmetic is exact up to this conversion.
    fn from_i64(value: i64) -> Self;
    /// The integer part, saturated at the ends of the range; zero for NaN.
    fn whole(self) -> i64;
    /// The value as an `f64`, exactly.
    fn to_f64(self) -> f64;

    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// e to the power of the value, minus one, accurate near zero.
    fn exp_m1(self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;

    /// The value clamped to `low..=high`. NaN stays NaN: the drive rejects a torque that is not finite.
    fn clamp(self, low: Self, high: Self) -> Self {
        if self < low {
            low
        } else if self > high {
            high
        } else {
            self
        }
    }

    /// Plus or minus one; zero at zero, so that a law at rest favours neither direction.
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

macro_rules! real {
    ($float:ident, $tanh:path, $exp_m1:path, $sqrt:path, $abs:path) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;

            fn from_f64(value: f64) -> Self {
                value as Self
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
                $tanh(self)
            }
            fn exp_m1(self) -> Self {
                $exp_m1(self)
            }
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            fn abs(self) -> Self {
                $abs(self)
            }
        }
    };
}

real!(f32, libm::tanhf, libm::expm1f, libm::sqrtf, libm::fabsf);
real!(f64, libm::tanh, libm::expm1, libm::sqrt, libm::fabs);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sign_of_zero_is_zero() {
        assert_eq!(0.0_f32.sign(), 0.0);
        assert_eq!((-0.0_f64).sign(), 0.0);
        assert_eq!((-2.5_f32).sign(), -1.0);
    }

    #[test]
    fn clamp_passes_nan() {
        assert!(Real::clamp(f32::NAN, -1.0, 1.0).is_nan());
        assert_eq!(Real::clamp(-3.0_f32, -1.0, 1.0), -1.0);
    }
}
