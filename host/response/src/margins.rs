//! Margins of a loop from its measured open loop and sensitivity.
//!
//! The loop was closed while it was measured, so it is stable, and every margin is a distance. Between two lines the logarithm of
//! the magnitude and the phase are taken as linear in the logarithm of the frequency.

use std::f64::consts::{PI, TAU};

use crate::response::{LEAST_COHERENCE, Line, Measured, decibels};

/// A margin, where it is, and half of its interval of 95 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margin {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// In dB for a gain, in degrees for a phase; a number for a sensitivity.
    pub value: f64,
    /// In the unit of the value.
    pub within: f64,
}

/// The margins of a loop. Each is absent if the lines don't reach it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Margins {
    /// Least distance of the phase to -180 degrees where the magnitude is 1, in degrees. Its frequency is the crossover.
    pub phase: Option<Margin>,
    /// Least delay, in s, that takes the phase at a crossover to -180 degrees.
    pub delay_s: Option<f64>,
    /// Least factor in dB by which the gain may rise.
    pub gain: Option<Margin>,
    /// Least factor in dB, below 0, by which the gain may fall.
    pub lowest_gain: Option<Margin>,
    /// Largest sensitivity. 1 over it is the least distance of the open loop to -1.
    pub sensitivity: Option<Margin>,
}

impl Margins {
    /// The margins of a measured loop.
    #[must_use]
    pub fn of(measured: &Measured) -> Self {
        let is_coherent = |line: &&Line| line.coherence >= LEAST_COHERENCE;
        let loops: Vec<&Line> = measured.open_loop.iter().filter(is_coherent).collect();
        let mut margins = Self::default();
        for pair in loops.windows(2) {
            margins.take_crossover(pair[0], pair[1]);
            margins.take_half_turn(pair[0], pair[1]);
        }
        let largest = measured.sensitivity.iter().filter(is_coherent);
        let largest = largest.max_by(|one, other| one.value.norm().total_cmp(&other.value.norm()));
        margins.sensitivity = largest.map(|line| Margin {
            frequency_hz: line.frequency_hz,
            value: line.value.norm(),
            within: line.t95() * line.deviation,
        });
        margins
    }

    fn take_crossover(&mut self, low: &Line, high: &Line) {
        let [from, to] = [low, high].map(|line| line.value.norm().ln());
        if (from < 0.0) == (to < 0.0) {
            return;
        }
        let share = from / (from - to);
        let phase = low.value.arg() + share * turn(low, high);
        let distance = (phase + PI + PI).rem_euclid(TAU) - PI;
        let within = between(share, low.within_deg(), high.within_deg());
        let margin =
            Margin { frequency_hz: frequency_hz(share, low, high), value: distance.to_degrees(), within };
        // A delay only turns backwards: from a phase beyond -180 degrees it takes almost a turn.
        let delay_s = distance.rem_euclid(TAU) / TAU / margin.frequency_hz;
        self.delay_s = Some(self.delay_s.map_or(delay_s, |known| known.min(delay_s)));
        if self.phase.is_none_or(|known| margin.value.abs() < known.value.abs()) {
            self.phase = Some(margin);
        }
    }

    /// A crossing of -180 degrees.
    fn take_half_turn(&mut self, low: &Line, high: &Line) {
        // The phase relative to -180 degrees changes its sign between the lines.
        let from = (low.value.arg() + TAU).rem_euclid(TAU) - PI;
        let by = turn(low, high);
        let to = from + by;
        if (from < 0.0) == (to < 0.0) || by == 0.0 || from.abs() > 0.5 * PI {
            return;
        }
        let share = -from / by;
        let magnitude = between(share, low.value.norm().ln(), high.value.norm().ln()).exp();
        let within = between(share, low.within_db(), high.within_db());
        let margin =
            Margin { frequency_hz: frequency_hz(share, low, high), value: -decibels(magnitude), within };
        let kept = if margin.value >= 0.0 { &mut self.gain } else { &mut self.lowest_gain };
        if kept.is_none_or(|known| margin.value.abs() < known.value.abs()) {
            *kept = Some(margin);
        }
    }
}

/// Change of the phase from a line to the next one, by the shorter way, in rad.
fn turn(low: &Line, high: &Line) -> f64 {
    (high.value / low.value).arg()
}

fn between(share: f64, low: f64, high: f64) -> f64 {
    low + share * (high - low)
}

fn frequency_hz(share: f64, low: &Line, high: &Line) -> f64 {
    between(share, low.frequency_hz.ln(), high.frequency_hz.ln()).exp()
}

#[cfg(test)]
mod tests {
    use rustfft::num_complex::Complex;

    use super::*;

    /// The loop 1 / s / (s + 1)^2 x gain, at 200 lines.
    fn measured(gain: f64) -> Measured {
        let line = |frequency_hz: f64, value| Line {
            frequency_hz,
            value,
            deviation: 0.0,
            coherence: 1.0,
            realisations: 8,
        };
        let open_loop: Vec<Line> = (0..200)
            .map(|at| 0.01 * 10_f64.powf(f64::from(at) / 66.0))
            .map(|frequency_hz| {
                let s = Complex::new(0.0, TAU * frequency_hz);
                line(frequency_hz, gain / (s * (s + 1.0) * (s + 1.0)))
            })
            .collect();
        let sensitivity = open_loop.iter().map(|it| line(it.frequency_hz, 1.0 / (1.0 + it.value))).collect();
        let (motor, load, closed_loop, torque_nm) = Default::default();
        Measured { motor, load, sensitivity, open_loop, closed_loop, torque_nm }
    }

    #[test]
    fn margins_of_a_known_loop_are_those_of_its_formula() {
        // Phase -180 at 1 rad/s, where the magnitude is gain / 2. Magnitude 1 for a gain of 1 at 0.6823 rad/s: w (1 + w^2) = 1.
        let margins = Margins::of(&measured(1.0));
        let gain = margins.gain.expect("a gain margin");
        assert!(
            (gain.value - 6.0206).abs() < 0.01 && (gain.frequency_hz * TAU - 1.0).abs() < 1e-3,
            "{gain:?}"
        );
        let phase = margins.phase.expect("a phase margin");
        let want_deg = 90.0 - 2.0 * 0.682_328_f64.atan().to_degrees();
        assert!((phase.value - want_deg).abs() < 0.05, "{phase:?}, want {want_deg}");
        assert!((phase.frequency_hz * TAU - 0.682_328).abs() < 1e-3, "{phase:?}");
        assert_eq!(margins.lowest_gain, None);
    }

    /// A resonance beyond the first crossover: there the phase margin is larger, and the delay margin smaller.
    #[test]
    fn delay_margin_is_the_least_over_all_crossovers() {
        let mut of = measured(1.0);
        for it in &mut of.open_loop {
            let s = Complex::new(0.0, TAU * it.frequency_hz);
            it.value = 1.0 / s + 0.2 * s / (s * s + 0.02 * s + 25.0);
        }
        let margins = Margins::of(&of);
        let phase = margins.phase.expect("a phase margin");
        let at_least_phase_s = phase.value / 360.0 / phase.frequency_hz;
        let delay_s = margins.delay_s.expect("a delay margin");
        let crossovers =
            of.open_loop.windows(2).filter(|it| (it[0].value.norm() < 1.0) != (it[1].value.norm() < 1.0));
        let least_s = crossovers
            .map(|it| (it[0].value.arg() + PI).rem_euclid(TAU) / TAU / it[0].frequency_hz)
            .fold(f64::MAX, f64::min);
        assert!(delay_s < 0.5 * at_least_phase_s, "{delay_s} s, {at_least_phase_s} s by {phase:?}");
        assert!((delay_s / least_s - 1.0).abs() < 0.1, "{delay_s} s for {least_s} s");
    }

    #[test]
    fn a_delay_takes_a_negative_margin_almost_a_turn() {
        let mut of = measured(1.0);
        for it in &mut of.open_loop {
            // A magnitude of 1 at 1 Hz, at 10 degrees beyond -180.
            it.value = Complex::from_polar(1.0 / it.frequency_hz, -PI - 10_f64.to_radians());
        }
        let margins = Margins::of(&of);
        let (phase, delay_s) = (margins.phase.expect("a margin"), margins.delay_s.expect("a margin"));
        assert!((phase.value + 10.0).abs() < 1e-9, "{phase:?}");
        assert!((delay_s - 350.0 / 360.0).abs() < 1e-6, "{delay_s}");
    }

    #[test]
    fn largest_sensitivity_is_one_over_the_least_distance_to_minus_one() {
        let of = measured(1.0);
        let least = of.open_loop.iter().map(|it| (it.value + 1.0).norm()).fold(f64::MAX, f64::min);
        let sensitivity = Margins::of(&of).sensitivity.expect("a largest value");
        assert!((sensitivity.value * least - 1.0).abs() < 1e-12, "{sensitivity:?}");
    }

    #[test]
    fn lines_that_end_below_the_crossover_have_no_margin() {
        let mut of = measured(1.0);
        of.open_loop.truncate(20);
        let margins = Margins::of(&of);
        assert_eq!((margins.phase, margins.gain), (None, None));
    }
}
