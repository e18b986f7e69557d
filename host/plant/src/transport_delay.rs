//! The transport delay from the drive's torque command to the motor.
//!
//! A torque is held at the motor from its arrival to that of the next one. A constant delay of whole periods only shifts the
//! torques. With any other constant delay, each period begins with the older of two torques and ends with the newer. With
//! jitter a period may have no arrival or several. Torques keep their order: one that would overtake an older one arrives
//! together with it. A lost torque never arrives.

use std::collections::VecDeque;

use crate::Numbers;
use crate::random::{Pcg64Mcg, SeedableRng, uniform};

/// Random numbers that each torque takes.
const DRAWS_PER_TORQUE: u64 = 2;

/// A delay line for held torques, with its contents.
#[derive(Debug, Clone, PartialEq)]
pub struct TransportDelay {
    period_us: u64,
    delay_us: u64,
    variation: Option<Variation>,
    /// Beginning of the next period.
    now_us: u64,
    /// The torque at the motor.
    held_nm: f64,
    /// Torques that have not arrived yet, oldest first, each after its time of arrival.
    in_transit: VecDeque<(u64, f64)>,
}

/// What differs from torque to torque.
#[derive(Debug, Clone, PartialEq)]
struct Variation {
    jitter_us: u64,
    loss: f64,
    random: Pcg64Mcg,
}

impl Variation {
    /// The jitter of the next torque; `None` if the torque is lost. Every torque takes [`DRAWS_PER_TORQUE`].
    fn next(&mut self) -> Option<u64> {
        let (lateness, chance) = (uniform(&mut self.random), uniform(&mut self.random));
        (chance >= self.loss).then(|| (lateness * (self.jitter_us + 1) as f64) as u64)
    }
}

impl TransportDelay {
    /// A delay line that holds zero torque. Both times are in microseconds, so that whole periods are exact.
    ///
    /// # Panics
    /// The period is zero.
    pub fn new(delay_us: u32, period_us: u32) -> Self {
        let (periods, remainder_us) = (u64::from(delay_us / period_us), u64::from(delay_us % period_us));
        // Two more, for the torque of this period and for a part of one: a step allocates nothing.
        let mut in_transit = VecDeque::with_capacity(periods as usize + 2);
        // Zero torque of the periods before the first: the periods of a run are divided alike from the beginning.
        in_transit.extend((0..periods).map(|period| (period * u64::from(period_us) + remainder_us, 0.0)));
        Self {
            period_us: period_us.into(),
            delay_us: delay_us.into(),
            variation: None,
            now_us: 0,
            held_nm: 0.0,
            in_transit,
        }
    }

    /// Every torque is delayed by a further time, uniform from 0 to `jitter_us` in whole microseconds, and lost with the
    /// probability `loss`. `seed` determines both.
    #[must_use]
    pub fn with_variation(mut self, jitter_us: u32, loss: f64, seed: u64) -> Self {
        if jitter_us > 0 || loss > 0.0 {
            self.in_transit.reserve((u64::from(jitter_us) / self.period_us) as usize + 1);
            let random = Pcg64Mcg::seed_from_u64(seed);
            self.variation = Some(Variation { jitter_us: jitter_us.into(), loss, random });
        }
        self
    }

    /// Whether every torque is at the motor as soon as it is commanded.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.delay_us == 0 && self.variation.is_none()
    }

    /// Appends the contents in numbers, for [`resumed`](Self::resumed).
    pub fn save(&self, numbers: &mut Vec<f64>) {
        numbers.extend([self.now_us as f64, self.held_nm, self.in_transit.len() as f64]);
        numbers.extend(
            self.in_transit.iter().flat_map(|&(arrival_us, torque_nm)| [arrival_us as f64, torque_nm]),
        );
    }

    /// This new delay line with the contents that [`save`](Self::save) gave; `None` if the numbers are something else.
    pub fn resumed(mut self, numbers: &mut Numbers<'_>) -> Option<Self> {
        let mut next = || numbers.next();
        self.now_us = next()? as u64;
        self.held_nm = next()?;
        self.in_transit.clear();
        for _ in 0..next()? as usize {
            self.in_transit.push_back((next()? as u64, next()?));
        }
        if let Some(variation) = &mut self.variation {
            variation.random.advance(u128::from(DRAWS_PER_TORQUE * self.now_us / self.period_us));
        }
        Some(self)
    }

    /// Takes the torque of this period; returns the torques held at the motor during it, each with its duration in s. The
    /// durations add up to the period.
    pub fn step(&mut self, torque_nm: f64) -> impl Iterator<Item = (f64, f64)> {
        let begin_us = self.now_us;
        if let Some(jitter_us) = self.variation.as_mut().map_or(Some(0), Variation::next) {
            let arrival_us = begin_us + self.delay_us + jitter_us;
            let in_order_us =
                self.in_transit.back().map_or(arrival_us, |&(last_us, _)| arrival_us.max(last_us));
            self.in_transit.push_back((in_order_us, torque_nm));
        }
        self.now_us += self.period_us;
        HeldTorques { line: self, at_us: begin_us, held_s: 0.0 }
    }
}

/// The torques held during one period.
struct HeldTorques<'a> {
    line: &'a mut TransportDelay,
    at_us: u64,
    held_s: f64,
}

impl Iterator for HeldTorques<'_> {
    /// Torque and duration.
    type Item = (f64, f64);

    fn next(&mut self) -> Option<(f64, f64)> {
        let Self { line, at_us, held_s } = self;
        while let Some((_, torque_nm)) = line.in_transit.pop_front_if(|(arrival_us, _)| arrival_us <= at_us) {
            line.held_nm = torque_nm;
        }
        let end_us = line.now_us;
        let until_us = line.in_transit.front().map_or(end_us, |&(arrival_us, _)| arrival_us.min(end_us));
        if *at_us == end_us {
            return None;
        }
        let part_s = if until_us == end_us {
            line.period_us as f64 / 1e6 - *held_s
        } else {
            (until_us - *at_us) as f64 / 1e6
        };
        (*at_us, *held_s) = (until_us, *held_s + part_s);
        Some((line.held_nm, part_s))
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

    #[test]
    fn jittered_torques_keep_their_order_and_fill_every_period() {
        let mut delay = TransportDelay::new(300, 1000).with_variation(5000, 0.0, 7);
        let (mut last_nm, mut counts) = (0.0, [0; 3]);
        for step in 1..=10_000 {
            let parts: Vec<_> = delay.step(f64::from(step)).collect();
            let sum_s: f64 = parts.iter().map(|(_, part_s)| part_s).sum();
            assert!(
                (sum_s - 1e-3).abs() < 1e-15 && parts.iter().all(|(_, part_s)| *part_s > 0.0),
                "{parts:?}"
            );
            for (torque_nm, _) in &parts {
                assert!(*torque_nm >= last_nm, "{torque_nm} after {last_nm}");
                last_nm = *torque_nm;
            }
            counts[parts.len().min(3) - 1] += 1;
        }
        assert!(last_nm > 9990.0, "{last_nm}");
        assert!(counts.iter().all(|&count| count > 100), "periods with one part, two, more: {counts:?}");
    }

    #[test]
    fn lost_torques_are_the_given_fraction_and_the_older_one_is_held() {
        let mut delay = TransportDelay::new(0, 1000).with_variation(0, 0.2, 3);
        let (mut lost, mut last_nm) = (0, 0.0);
        for step in 1..=20_000 {
            let parts: Vec<_> = delay.step(f64::from(step)).collect();
            let [(torque_nm, _)] = parts[..] else { panic!("{parts:?}") };
            if torque_nm == last_nm {
                lost += 1;
            } else {
                assert_eq!(torque_nm, f64::from(step));
            }
            last_nm = torque_nm;
        }
        // Four standard deviations of a binomial distribution: 4 sqrt(20000 x 0.2 x 0.8) = 226.
        assert!((4000 - 226..=4000 + 226).contains(&lost), "{lost} of 20000");
    }

    #[test]
    fn a_seed_repeats_its_delays_and_another_does_not() {
        let with = |seed| {
            let mut delay = TransportDelay::new(500, 1000).with_variation(3000, 0.1, seed);
            (0..100).map(|step| delay.step(step.into()).collect()).collect::<Vec<Vec<_>>>()
        };
        assert_eq!(with(1), with(1));
        assert_ne!(with(1), with(2));
    }
}
