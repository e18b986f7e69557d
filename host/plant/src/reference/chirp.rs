//! A sine whose frequency rises from one value to another: equal times for equal ratios.

use std::f64::consts::TAU;

use serde::Serialize;

/// offset + amplitude sin(phase), with the phase growing at a frequency that moves from one value to another, exponentially
/// over the duration; the last frequency stays.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Chirp {
    /// Half of peak to peak, in rad.
    pub amplitude_rad: f64,
    /// Frequency at time 0.
    pub from_hz: f64,
    /// Frequency from the end of the sweep on.
    pub to_hz: f64,
    /// Time from the first frequency to the last, in s.
    pub sweep_s: f64,
    /// Middle, where it begins.
    pub offset_rad: f64,
}

impl Chirp {
    /// Reference position in rad at a time of the run.
    #[must_use]
    pub fn position_rad(&self, t_s: f64) -> f64 {
        self.offset_rad + self.amplitude_rad * libm::sin(TAU * self.turns(t_s))
    }

    /// Integral of the frequency f(t) = f_0 (f_1 / f_0)^(t / T): cycles since time 0.
    fn turns(&self, t_s: f64) -> f64 {
        let growth = libm::log(self.to_hz / self.from_hz);
        let within_s = t_s.clamp(0.0, self.sweep_s);
        let turns = if growth.abs() < 1e-9 {
            self.from_hz * within_s
        } else {
            self.from_hz * self.sweep_s / growth * libm::expm1(growth * within_s / self.sweep_s)
        };
        turns + self.to_hz * (t_s - within_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHIRP: Chirp =
        Chirp { amplitude_rad: 2.0, from_hz: 1.0, to_hz: 16.0, sweep_s: 4.0, offset_rad: 0.5 };

    /// Frequency by the turns of a short time.
    fn frequency_hz(chirp: &Chirp, t_s: f64) -> f64 {
        (chirp.turns(t_s + 5e-6) - chirp.turns(t_s - 5e-6)) / 1e-5
    }

    #[test]
    fn frequency_grows_by_equal_ratios_in_equal_times_and_then_stays() {
        for (t_s, want) in [(1.0, 2.0), (2.0, 4.0), (3.0, 8.0), (3.999, 15.99), (5.0, 16.0), (90.0, 16.0)] {
            let have = frequency_hz(&CHIRP, t_s);
            assert!((have - want).abs() < 2e-3, "at {t_s} s: have {have}, want {want}");
        }
    }

    #[test]
    fn chirp_begins_in_its_middle_and_stays_within_its_amplitude() {
        assert_eq!(CHIRP.position_rad(0.0), 0.5);
        assert!((0..8000).all(|at| (CHIRP.position_rad(f64::from(at) * 1e-3) - 0.5).abs() <= 2.0));
    }

    #[test]
    fn chirp_between_equal_frequencies_is_a_sine() {
        let sine = Chirp { to_hz: 1.0, ..CHIRP };
        assert!((sine.position_rad(0.3) - (0.5 + 2.0 * (TAU * 0.3).sin())).abs() < 1e-12);
    }
}
