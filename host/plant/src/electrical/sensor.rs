//! The sensor of the motor's current, with its converter.

use super::parameters::ElectricalParameters;
use crate::random::{Pcg64Mcg, SeedableRng, uniform};

/// A sensor and the state of its noise.
#[derive(Debug, Clone, PartialEq)]
pub struct CurrentSensor {
    noise: Pcg64Mcg,
}

impl CurrentSensor {
    /// A sensor; `seed` starts its noise.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { noise: Pcg64Mcg::seed_from_u64(seed) }
    }

    /// What the converter reads for a current, as a fraction of its range, -1 to 1: with offset and noise, in whole steps.
    pub fn read(&mut self, parameters: &ElectricalParameters, current_a: f64) -> f64 {
        let ElectricalParameters { sense_range_a, sense_offset_a, sense_noise_a, sense_bits, .. } =
            *parameters;
        let noise_a = sense_noise_a * (2.0 * uniform(&mut self.noise) - 1.0);
        let fraction = (current_a + sense_offset_a + noise_a) / sense_range_a;
        let steps = f64::from(1_u32 << (sense_bits - 1));
        libm::rint(fraction * steps).clamp(-steps, steps - 1.0) / steps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_has_steps_an_offset_and_an_end() {
        let coarse = ElectricalParameters {
            sense_range_a: 10.0,
            sense_offset_a: 1.0,
            sense_bits: 6,
            ..ElectricalParameters::example()
        };
        let mut sensor = CurrentSensor::new(1);
        // 32 steps to 10 A.
        for (current_a, want) in
            [(-1.0, 0.0), (0.0, 3.0 / 32.0), (4.0, 0.5), (20.0, 31.0 / 32.0), (-20.0, -1.0)]
        {
            assert_eq!(sensor.read(&coarse, current_a), want, "{current_a} A");
        }
    }

    #[test]
    fn noise_fills_its_width_and_repeats_with_its_seed() {
        let noisy =
            ElectricalParameters { sense_noise_a: 2.0, sense_bits: 20, ..ElectricalParameters::example() };
        let readings = |seed| {
            let mut sensor = CurrentSensor::new(seed);
            (0..10_000).map(|_| 100.0 * sensor.read(&noisy, 0.0)).collect::<Vec<_>>()
        };
        let have = readings(3);
        let (low, high) =
            have.iter().fold((0.0_f64, 0.0_f64), |(low, high), it| (low.min(*it), high.max(*it)));
        assert!((-2.0..-1.99).contains(&low) && (1.99..2.0).contains(&high), "{low} to {high} A");
        assert_eq!(have, readings(3));
        assert_ne!(have, readings(4));
    }
}
