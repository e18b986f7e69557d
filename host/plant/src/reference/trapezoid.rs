//! A positioning move: acceleration, constant velocity, deceleration. A move too short to reach the velocity limit is
//! triangular: deceleration begins half way.

use serde::Serialize;

/// A move from rest to rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trapezoid {
    /// Position until `start_s`.
    pub from_rad: f64,
    /// Position at the end.
    pub to_rad: f64,
    /// Time at which the move begins.
    pub start_s: f64,
    /// Velocity limit in rad/s, above 0.
    pub velocity_rad_s: f64,
    /// Acceleration and deceleration in rad/s^2, above 0.
    pub acceleration_rad_s2: f64,
}

impl Trapezoid {
    /// Reference position in rad at a time of the run.
    #[must_use]
    pub fn position_rad(&self, t_s: f64) -> f64 {
        let distance = (self.to_rad - self.from_rad).abs();
        let peak_velocity = self.velocity_rad_s.min((distance * self.acceleration_rad_s2).sqrt());
        let ramp_s = peak_velocity / self.acceleration_rad_s2;
        // Both ramps together take 2 v/a and cover v^2/a; the rest runs at v. Without distance v is zero and can't divide.
        let total_s = if distance > 0.0 { distance / peak_velocity + ramp_s } else { 0.0 };
        let elapsed_s = t_s - self.start_s;
        if elapsed_s <= 0.0 {
            return self.from_rad;
        }
        if elapsed_s >= total_s {
            return self.to_rad;
        }
        let ramp = |time_s: f64| self.acceleration_rad_s2 * time_s * time_s / 2.0;
        let travelled = if elapsed_s < ramp_s {
            ramp(elapsed_s)
        } else if elapsed_s <= total_s - ramp_s {
            ramp(ramp_s) + peak_velocity * (elapsed_s - ramp_s)
        } else {
            distance - ramp(total_s - elapsed_s)
        };
        self.from_rad + travelled.copysign(self.to_rad - self.from_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::Trapezoid;

    fn trapezoid(from_rad: f64, to_rad: f64) -> Trapezoid {
        Trapezoid { from_rad, to_rad, start_s: 1.0, velocity_rad_s: 2.0, acceleration_rad_s2: 4.0 }
    }

    #[track_caller]
    fn assert_at(trapezoid: &Trapezoid, t_s: f64, want: f64) {
        let have = trapezoid.position_rad(t_s);
        assert!((have - want).abs() < 1e-12, "at {t_s} s: have {have}, want {want}");
    }

    #[test]
    fn long_move_reaches_the_velocity_limit() {
        // 0.5 s and 0.5 rad for each ramp, 3 rad at 2 rad/s between them.
        let trapezoid = trapezoid(0.0, 4.0);
        for (t_s, want) in [
            (0.0, 0.0),
            (1.0, 0.0),
            (1.25, 0.125),
            (1.5, 0.5),
            (2.0, 1.5),
            (3.0, 3.5),
            (3.25, 3.875),
            (3.5, 4.0),
        ] {
            assert_at(&trapezoid, t_s, want);
        }
        assert_eq!(trapezoid.position_rad(100.0), 4.0);
    }

    #[test]
    fn short_move_is_triangular() {
        // Half of 0.25 rad at 4 rad/s^2 takes 0.25 s and peaks at 1 rad/s.
        let trapezoid = trapezoid(1.0, 1.25);
        for (t_s, want) in [(1.125, 1.031_25), (1.25, 1.125), (1.375, 1.218_75), (1.5, 1.25)] {
            assert_at(&trapezoid, t_s, want);
        }
    }

    #[test]
    fn backward_move_mirrors_the_forward_move() {
        for step in 0..400 {
            let t_s = f64::from(step) * 0.01;
            assert_at(&trapezoid(0.0, -4.0), t_s, -trapezoid(0.0, 4.0).position_rad(t_s));
        }
    }

    #[test]
    fn velocity_and_acceleration_stay_within_their_limits() {
        let (trapezoid, h) = (trapezoid(-1.0, 3.0), 1e-3);
        for step in 1..4000 {
            let t_s = f64::from(step) * h;
            let [before, now, after] = [t_s - h, t_s, t_s + h].map(|t_s| trapezoid.position_rad(t_s));
            assert!(((after - now) / h).abs() <= 2.0 + 1e-9, "velocity at {t_s} s");
            assert!(((after - 2.0 * now + before) / (h * h)).abs() <= 4.0 + 1e-6, "acceleration at {t_s} s");
        }
    }

    #[test]
    fn move_over_zero_distance_stays() {
        assert_eq!(trapezoid(0.3, 0.3).position_rad(1.2), 0.3);
    }
}
