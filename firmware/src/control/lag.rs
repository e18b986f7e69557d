//! First-order lags with a held input.

use crate::law::Real;

/// Gain alpha of a first-order lag of `rate` (1/s) over `time` (s): `1 - e^(-rate time)`.
pub(in crate::control) fn alpha<F: Real>(rate: F, time: F) -> F {
    -(-(rate * time)).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_of_a_slow_lag_keeps_its_digits_in_single_precision() {
        // 1 - e^-x loses all but three digits of 1e-5 in f32 if computed by subtraction.
        let have = alpha(0.01_f32, 0.001);
        assert!((have.to_f64() / 9.99995e-6 - 1.0).abs() < 2e-7, "have {have}");
    }
}
