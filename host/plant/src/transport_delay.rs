//! The transport delay from the drive's torque command to the motor.
//!
//! A torque is held at the motor for one control period, which begins after the delay. A delay of whole periods only
//! shifts the torques. With any other delay, each period begins with the older of two torques and ends with the newer.

use std::collections::VecDeque;

/// A delay line for held torques, with its contents.
#[derive(Debug, Clone, PartialEq)]
pub struct TransportDelay {
    period_s: f64,
    /// Time from the beginning of each period to the change of torque.
    remainder_s: f64,
    /// Torques that have not arrived yet, oldest first.
    in_transit_nm: VecDeque<f64>,
}

impl TransportDelay {
    /// A delay line that holds zero torque. Both times are in microseconds, so that whole periods are exact.
    ///
    /// # Panics
    /// The period is zero.
    pub fn new(delay_us: u32, period_us: u32) -> Self {
        let (periods, remainder_us) = (delay_us / period_us, delay_us % period_us);
        let torques = periods as usize + usize::from(remainder_us > 0);
        // One more, because a step adds the newest torque before it removes the oldest: a step allocates nothing.
        let mut in_transit_nm = VecDeque::with_capacity(torques + 1);
        in_transit_nm.resize(torques, 0.0);
        Self {
            period_s: f64::from(period_us) / 1e6,
            remainder_s: f64::from(remainder_us) / 1e6,
            in_transit_nm,
        }
    }

    /// Takes the torque of this period; returns the torques held at the motor during it, each with its duration in s.
    pub fn step(&mut self, torque_nm: f64) -> impl Iterator<Item = (f64, f64)> + use<> {
        self.in_transit_nm.push_back(torque_nm);
        let oldest_nm = self.in_transit_nm.pop_front().unwrap_or(torque_nm);
        let newer_nm = self.in_transit_nm.front().copied().unwrap_or(torque_nm);
        let parts = if self.remainder_s > 0.0 {
            [(oldest_nm, self.remainder_s), (newer_nm, self.period_s - self.remainder_s)]
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
    fn delay_of_whole_periods_shifts_the_torques() {
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
