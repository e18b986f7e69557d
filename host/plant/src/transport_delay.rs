//! The way from the drive to the motor takes time.
//!
//! A torque that the drive gives at a sample is held at the motor for one control period, but later. A delay of whole
//! periods only shifts the torques; of any other, each period begins with the older of two torques and ends with the newer.

use std::collections::VecDeque;

/// A delay line for held torques, and what is in it.
#[derive(Debug, Clone, PartialEq)]
pub struct TransportDelay {
    period_s: f64,
    /// How long in each period the older torque is still there.
    rest_s: f64,
    /// Torques on their way, oldest first.
    on_the_way_nm: VecDeque<f64>,
}

impl TransportDelay {
    /// A delay with no torque in it. Both times are in microseconds, so that whole periods are whole.
    ///
    /// # Panics
    /// The period is nought.
    pub fn new(delay_us: u32, period_us: u32) -> Self {
        let (whole, rest_us) = (delay_us / period_us, delay_us % period_us);
        let torques = whole as usize + usize::from(rest_us > 0);
        // With room for the one that comes before the oldest goes: a step takes no memory.
        let mut on_the_way_nm = VecDeque::with_capacity(torques + 1);
        on_the_way_nm.resize(torques, 0.0);
        Self { period_s: f64::from(period_us) / 1e6, rest_s: f64::from(rest_us) / 1e6, on_the_way_nm }
    }

    /// Takes the torque of this period and gives what is held at the motor during it: torques and for how long each.
    pub fn step(&mut self, torque_nm: f64) -> impl Iterator<Item = (f64, f64)> + use<> {
        self.on_the_way_nm.push_back(torque_nm);
        let oldest_nm = self.on_the_way_nm.pop_front().unwrap_or(torque_nm);
        let newer_nm = self.on_the_way_nm.front().copied().unwrap_or(torque_nm);
        let parts = if self.rest_s > 0.0 {
            [(oldest_nm, self.rest_s), (newer_nm, self.period_s - self.rest_s)]
        } else {
            [(oldest_nm, self.period_s), (oldest_nm, 0.0)]
        };
        parts.into_iter().filter(|(_, held_s)| *held_s > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(delay_us: u32, torques: &[f64]) -> Vec<Vec<(f64, f64)>> {
        let mut delay = TransportDelay::new(delay_us, 1000);
        torques.iter().map(|&torque_nm| delay.step(torque_nm).collect()).collect()
    }

    #[test]
    fn without_delay_a_torque_is_held_at_once() {
        assert_eq!(held(0, &[1.0, 2.0]), [[(1.0, 1e-3)], [(2.0, 1e-3)]]);
    }

    #[test]
    fn torque_of_a_sample_is_held_from_that_many_samples_later_on() {
        assert_eq!(held(1000, &[1.0, 2.0, 3.0]), [[(0.0, 1e-3)], [(1.0, 1e-3)], [(2.0, 1e-3)]]);
        assert_eq!(held(2000, &[1.0, 2.0, 3.0]), [[(0.0, 1e-3)], [(0.0, 1e-3)], [(1.0, 1e-3)]]);
    }

    #[test]
    fn delay_of_part_of_a_period_changes_the_torque_within_it() {
        let have = held(1250, &[1.0, 2.0, 3.0]);
        let want =
            [[(0.0, 2.5e-4), (0.0, 7.5e-4)], [(0.0, 2.5e-4), (1.0, 7.5e-4)], [(1.0, 2.5e-4), (2.0, 7.5e-4)]];
        assert_eq!(have, want);
    }
}
