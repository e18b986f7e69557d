//! What a gap leaves of a stiffness, by describing functions: the first harmonic of the torque over that of the twist.
//!
//! Both are of a dead zone of half width j0 with the stiffness K beyond it (A. Gelb and W. E. Vander Velde, "Multiple-Input
//! Describing Functions and Nonlinear System Design", 1968). A stepped sine twists about as a sine, a multisine about as noise.

use std::f64::consts::{FRAC_2_PI, SQRT_2};

/// Share of the stiffness that a sine of this amplitude meets, in units of the half gap: 0 within it, 1 far beyond.
#[must_use]
pub fn share_for_sine(amplitude_over_half_gap: f64) -> f64 {
    if amplitude_over_half_gap <= 1.0 {
        return 0.0;
    }
    let within = 1.0 / amplitude_over_half_gap;
    1.0 - FRAC_2_PI * (within.asin() + within * (1.0 - within * within).sqrt())
}

/// Share of the stiffness that Gaussian noise of this root mean square meets, in units of the half gap.
#[must_use]
pub fn share_for_noise(rms_over_half_gap: f64) -> f64 {
    if rms_over_half_gap <= 0.0 { 0.0 } else { erfc(1.0 / (SQRT_2 * rms_over_half_gap)) }
}

/// The complementary error function of x >= 0 to 1.2e-7 of its value (W. H. Press et al., "Numerical Recipes", 6.2).
fn erfc(x: f64) -> f64 {
    const TERMS: [f64; 10] = [
        -1.265_512_23,
        1.000_023_68,
        0.374_091_96,
        0.096_784_18,
        -0.186_288_06,
        0.278_868_07,
        -1.135_203_98,
        1.488_515_87,
        -0.822_152_23,
        0.170_872_77,
    ];
    let t = 1.0 / (1.0 + 0.5 * x);
    let sum = TERMS.iter().rev().fold(0.0, |sum, term| term + t * sum);
    t * (sum - x * x).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of torque times sine over a cycle, by quadrature.
    fn first_harmonic(amplitude: f64) -> f64 {
        let points = 200_000;
        let turn = |at: i32| (f64::from(at) + 0.5) / f64::from(points) * std::f64::consts::TAU;
        let term = |at: i32| {
            let twist = amplitude * turn(at).sin();
            (twist - twist.clamp(-1.0, 1.0)) * turn(at).sin()
        };
        2.0 * (0..points).map(term).sum::<f64>() / f64::from(points) / amplitude
    }

    #[test]
    fn share_of_a_sine_is_the_first_harmonic_of_a_dead_zone() {
        for amplitude in [0.5, 1.0, 1.1, 1.5, 3.0, 20.0] {
            let (have, want) = (share_for_sine(amplitude), first_harmonic(amplitude));
            assert!((have - want).abs() < 1e-6, "{amplitude}: have {have}, want {want}");
        }
    }

    #[test]
    fn share_of_noise_is_the_mean_slope_of_a_dead_zone() {
        // The mean slope is the probability to be beyond the gap: 31.731 % beyond one deviation, 61.708 % beyond a half.
        for (rms, want) in [(1.0, 0.317_310_5), (2.0, 0.617_075_1), (0.5, 0.045_500_3)] {
            let have = share_for_noise(rms);
            assert!((have - want).abs() < 1e-6, "{rms}: have {have}, want {want}");
        }
    }
}
