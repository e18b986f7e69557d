//! A sum of sines whose frequencies are multiples of one, with random phases: a multisine.
//!
//! All tones have the same amplitude, and the sum is scaled to +-1 over its period. Phases draw from PCG XSL 128/64 by a seed;
//! the whole sum is then shifted in time so that it begins at zero, because a reference that jumps at its start excites more
//! than its tones.

use std::f64::consts::TAU;

use crate::random::{Pcg64Mcg, SeedableRng, uniform};

/// Points per cycle of the highest tone at which the sum is searched for its largest value. The tone itself turns by 18 degrees
/// from one point to the next, so the largest value is missed by 1.3 % at most.
const POINTS_PER_CYCLE: f64 = 20.0;
/// Halvings of the interval in which the sum crosses zero.
const HALVINGS: usize = 50;

/// A sum of sines of one amplitude, scaled to +-1.
#[derive(Debug, Clone, PartialEq)]
pub struct Tones {
    period_s: f64,
    amplitude: f64,
    /// Multiple of 1 / period, and phase at time 0.
    tones: Vec<(u32, f64)>,
}

impl Tones {
    /// Tones at these multiples of 1 / `period_s`, with the phases of this seed. One tone alone is a sine of phase 0.
    #[must_use]
    pub fn new(period_s: f64, harmonics: &[u32], seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let tones = harmonics.iter().map(|&harmonic| (harmonic, TAU * uniform(&mut random))).collect();
        let mut sum = Self { period_s, amplitude: 1.0, tones };
        let points =
            harmonics.iter().copied().max().map_or(1.0, |highest| POINTS_PER_CYCLE * f64::from(highest));
        let at = |point: f64| point * period_s / points;
        let values: Vec<f64> = (0..=points as u64).map(|point| sum.at(at(point as f64))).collect();
        let largest = match harmonics {
            [_] => 1.0,
            _ => values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs())),
        };
        let rises = values.windows(2).position(|pair| pair[0] <= 0.0 && pair[1] > 0.0);
        if let Some(point) = rises {
            let (mut low_s, mut high_s) = (at(point as f64), at(point as f64 + 1.0));
            for _ in 0..HALVINGS {
                let middle_s = 0.5 * (low_s + high_s);
                if sum.at(middle_s) <= 0.0 { low_s = middle_s } else { high_s = middle_s }
            }
            for (harmonic, phase) in &mut sum.tones {
                *phase = (*phase + TAU * f64::from(*harmonic) * low_s / period_s).rem_euclid(TAU);
            }
        }
        sum.amplitude = if largest > 0.0 { 1.0 / largest } else { 0.0 };
        sum
    }

    /// The sum at a time, within +-1; it repeats after its period.
    #[must_use]
    pub fn at(&self, t_s: f64) -> f64 {
        let turn = TAU * (t_s / self.period_s).rem_euclid(1.0);
        let tones = self.tones.iter().map(|&(harmonic, phase)| libm::sin(f64::from(harmonic) * turn + phase));
        self.amplitude * tones.sum::<f64>()
    }

    /// Odd multiples from `lowest` to `highest`, at most `lines` of them, at about equal ratios. Even ones stay free: a gap whose
    /// sides are alike puts its distortion on odd multiples only, so what appears on even ones shows an asymmetry.
    #[must_use]
    pub fn odd_harmonics(lowest: f64, highest: f64, lines: u32) -> Vec<u32> {
        let steps = f64::from(lines.saturating_sub(1).max(1));
        let largest = ((highest - 1.0) / 2.0).floor().max(0.0);
        let odd = |wanted: f64| 2 * ((wanted - 1.0) / 2.0).round().clamp(0.0, largest) as u32 + 1;
        let growth = libm::log((highest / lowest).max(1.0));
        let wanted = (0..lines).map(|line| lowest * libm::exp(growth * f64::from(line) / steps));
        let mut harmonics: Vec<u32> = wanted.map(odd).collect();
        harmonics.dedup();
        harmonics
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_begins_at_zero_repeats_after_its_period_and_reaches_one() {
        for seed in 0..20 {
            let tones = Tones::new(2.0, &Tones::odd_harmonics(1.0, 99.0, 20), seed);
            assert!(tones.at(0.0).abs() < 1e-9, "{}", tones.at(0.0));
            assert!((tones.at(0.3) - tones.at(2.3)).abs() < 1e-9);
            let largest = (0..20_000).map(|at| tones.at(f64::from(at) * 1e-4).abs()).fold(0.0, f64::max);
            assert!((0.999..1.014).contains(&largest), "seed {seed}: {largest}");
        }
    }

    #[test]
    fn a_single_tone_is_a_sine_from_zero() {
        let tones = Tones::new(0.5, &[3], 7);
        for t_s in [0.0, 0.01, 0.1, 0.24] {
            let want = (TAU * 6.0 * t_s).sin();
            assert!((tones.at(t_s) - want).abs() < 2e-6, "at {t_s} s: {}", tones.at(t_s));
        }
    }

    #[test]
    fn all_tones_have_one_amplitude() {
        let harmonics = [1, 5, 9, 33];
        let tones = Tones::new(1.0, &harmonics, 3);
        let samples = 1024;
        let amplitude = |harmonic: u32| {
            let turn = |at: i32| TAU * f64::from(harmonic) * f64::from(at) / f64::from(samples);
            let values = (0..samples).map(|at| (turn(at), tones.at(f64::from(at) / f64::from(samples))));
            let (re, im) =
                values.fold((0.0, 0.0), |(re, im), (turn, it)| (re + it * turn.cos(), im + it * turn.sin()));
            2.0 * re.hypot(im) / f64::from(samples)
        };
        let first = amplitude(1);
        assert!(harmonics.iter().all(|it| (amplitude(*it) / first - 1.0).abs() < 1e-9));
        assert!(amplitude(3) < 1e-12);
    }

    #[test]
    fn odd_harmonics_are_odd_distinct_and_within_their_ends() {
        let harmonics = Tones::odd_harmonics(1.0, 2000.0, 60);
        assert!(harmonics.windows(2).all(|pair| pair[0] < pair[1]), "{harmonics:?}");
        assert!(harmonics.iter().all(|it| it % 2 == 1));
        assert_eq!((harmonics[0], harmonics[harmonics.len() - 1] >= 1997), (1, true));
        assert!(harmonics.len() > 45, "{}", harmonics.len());
    }

    /// Pins the phases: other ones would change every run with a multisine.
    #[test]
    fn the_values_of_a_seed_are_pinned() {
        let tones = Tones::new(1.0, &[1, 3, 7], 1);
        let have = [0.1, 0.3, 0.9].map(|t_s| (tones.at(t_s) * 1e6).round());
        assert_eq!(have, [-472_334.0, 762_112.0, 114_500.0]);
    }
}
