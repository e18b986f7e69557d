//! Positions from the counts of the drive's encoders.

use std::f64::consts::TAU;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::BenchSample;

use crate::scenario::Scenario;

/// One encoder: counts without wraparound.
#[derive(Debug, Clone, Copy)]
struct Axis {
    counts: i64,
    rad_per_count: f64,
    /// Position at 0 counts.
    zero_rad: f64,
}

impl Axis {
    fn take(&mut self, reading: EncoderCounts) -> f64 {
        let moved = reading.wrapping_sub(EncoderCounts::wrapping(self.counts));
        self.counts += i64::from(moved);
        self.zero_rad + self.counts as f64 * self.rad_per_count
    }
}

/// Both encoders. Their zero is where they stood when the drive was powered up, and that is the start of the scenario.
#[derive(Debug, Clone, Copy)]
pub(super) struct BenchPositions {
    motor: Axis,
    load: Axis,
}

impl BenchPositions {
    pub(super) fn new(scenario: &Scenario) -> Self {
        let axis = |counts_per_rev: u32, zero_rad| Axis {
            counts: 0,
            rad_per_count: TAU / f64::from(counts_per_rev),
            zero_rad,
        };
        let (encoders, start) = (&scenario.encoders, &scenario.plant.initial);
        Self {
            motor: axis(encoders.motor_counts_per_rev, start.motor_position_rad),
            load: axis(encoders.load_counts_per_rev, start.load_position_rad),
        }
    }

    /// Position of the load at which the load encoder reads 0.
    pub(super) fn load_zero_rad(&self) -> f64 {
        self.load.zero_rad
    }

    /// Positions of motor and load in rad.
    pub(super) fn take(&mut self, sample: &BenchSample) -> (f64, f64) {
        (self.motor.take(sample.motor_counts), self.load.take(sample.load_counts))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_go_on_where_the_counts_of_24_bits_wrap() {
        const RANGE: i64 = 1 << 23;
        for way in [1, -1] {
            let mut axis = Axis { counts: 0, rad_per_count: 0.5, zero_rad: 3.0 };
            // A reading that far from the zero of power-up is the nearest one.
            for counts in (RANGE - 1_000..RANGE + 1_000).step_by(7).map(|counts| way * counts) {
                let want_rad = 3.0 + counts as f64 * 0.5;
                assert_eq!(axis.take(EncoderCounts::wrapping(counts)), want_rad, "at {counts}");
            }
        }
    }
}
