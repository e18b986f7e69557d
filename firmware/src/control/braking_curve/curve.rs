//! The braking curve: the fastest load velocity from which the load still stops at its target.
//!
//! For a distance s to the target, with d the planned deceleration, l the braking rate and l_L the landing rate:
//!
//! ```text
//! s < s_L:        v = l_L s + (l - l_L) s^2 / (2 s_L)
//! s - s_0 < s_1:  v = l (s - s_0)
//! beyond:         v = sqrt(2 d (s - s_0 - s_1 / 2))
//! s_0 = s_L (l - l_L) / (2 l),  s_1 = d / l^2
//! ```
//!
//! The root is the stop at constant deceleration. It has an infinite slope at the target, so a line takes over, and near
//! the target a parabola, which lands slowly enough for dry friction to stop the load. Velocity and slope are continuous
//! while d is at least l s_L (l + l_L) / 2; with a smaller d the velocity steps up at s_L.

use crate::law::Real;

/// The curve with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Curve<F> {
    pub(super) deceleration_rad_s2: F,
    pub(super) rate_1_s: F,
    pub(super) landing_rate_1_s: F,
    pub(super) landing_rad: F,
    pub(super) top_speed_rad_s: F,
}

impl<F: Real> Curve<F> {
    /// Velocity in rad/s at this distance in rad, not negative, and its slope in 1/s. `inertia_factor` divides the deceleration.
    pub(super) fn at(&self, distance_rad: F, inertia_factor: F) -> (F, F) {
        let half = F::from_f64(0.5);
        let (rate, landing) = (self.rate_1_s, self.landing_rate_1_s);
        let (velocity, slope) = if distance_rad < self.landing_rad {
            let bend = (rate - landing) / self.landing_rad * distance_rad;
            ((landing + half * bend) * distance_rad, landing + bend)
        } else {
            let beyond = distance_rad - half * self.landing_rad * (rate - landing) / rate;
            let d = self.deceleration_rad_s2 / inertia_factor;
            let linear_rad = d / (rate * rate);
            if beyond < linear_rad {
                (rate * beyond, rate)
            } else {
                let velocity = ((d + d) * (beyond - half * linear_rad)).sqrt();
                (velocity, d / velocity)
            }
        };
        if velocity < self.top_speed_rad_s { (velocity, slope) } else { (self.top_speed_rad_s, F::ZERO) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVE: Curve<f64> = Curve {
        deceleration_rad_s2: 5.8,
        rate_1_s: 10.0,
        landing_rate_1_s: 1.65,
        landing_rad: 0.047,
        top_speed_rad_s: 3.0,
    };

    #[test]
    fn velocity_is_continuous_and_the_slope_is_its_derivative() {
        let step = 1e-6;
        for k in 0..1_000_000 {
            let s = f64::from(k) * step;
            let ((v, slope), (next, _)) = (CURVE.at(s, 1.0), CURVE.at(s + step, 1.0));
            let have = (next - v) / step;
            let corner = next == CURVE.top_speed_rad_s;
            assert!(corner || (have - slope).abs() < 2e-4, "at {s} rad: slope {slope}, difference {have}");
        }
    }

    #[test]
    fn load_on_the_root_decelerates_as_planned() {
        for s in [0.2, 0.4, 0.7] {
            let (v, slope) = CURVE.at(s, 1.0);
            assert!((v * slope - 5.8).abs() < 1e-12, "at {s} rad");
        }
    }

    #[test]
    fn curve_starts_at_the_landing_rate_and_ends_at_the_top_speed() {
        assert_eq!(CURVE.at(0.0, 1.0), (0.0, 1.65));
        assert_eq!(CURVE.at(2.0, 1.0), (3.0, 0.0));
    }
}
