//! The time that frames take on a serial line, per control cycle.
//!
//! Ten bits a byte, each direction for itself, nothing ever waits for a computer: what is found here is the best that a
//! wire can do. In a cycle the sample goes out, then the torque comes back, and after every n-th torque telemetry follows it.
//! Telemetry that is still on the wire when the next torque is ready delays it:
//!
//! ```text
//! out   |sample|                      |sample|
//! back         |torque|    telemetry         |torque|
//! ```
//!
//! Lengths of frames are those of the protocol's own layouts.

use std::time::Duration;

use lashloop_protocol::layout::MessageLayout;
use lashloop_protocol::message::{EncoderSample, Telemetry, TorqueAnswer};
use lashloop_protocol::wire::Payload;

use lashloop_bench::link::uart_model::time_of;
use lashloop_bench::run::real_time::PERIOD_MARGIN;

/// Goes out in every period.
pub const SAMPLE: &MessageLayout = &EncoderSample::LAYOUT;
/// Comes back in every period.
pub const TORQUE: &MessageLayout = &TorqueAnswer::LAYOUT;
/// Comes back in some.
pub const TELEMETRY: &MessageLayout = &Telemetry::LAYOUT;

/// Speeds that adapters offer, in bits a second.
pub const USUAL_BAUD: [u32; 11] = [
    115_200, 230_400, 460_800, 921_600, 1_000_000, 1_500_000, 2_000_000, 3_000_000, 4_000_000, 6_000_000,
    12_000_000,
];

/// A line and what is asked of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Budget {
    /// Bits a second.
    pub baud: u32,
    /// The control period.
    pub period: Duration,
    /// Telemetry follows every so many torques; 0 for never.
    pub telemetry_every: u16,
}

/// Which cycles are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cycle {
    /// All of them on average.
    Mean,
    /// The one with telemetry, and the torque that comes behind it.
    Worst,
}

impl Budget {
    /// Time of a frame on the wire.
    #[must_use]
    pub fn frame(&self, layout: &MessageLayout) -> Duration {
        time_of(layout.frame_len() as u64, self.baud)
    }

    /// Share of torques that telemetry follows, 0 to 1.
    fn telemetry_share(&self) -> f64 {
        if self.telemetry_every == 0 { 0.0 } else { 1.0 / f64::from(self.telemetry_every) }
    }

    /// Bytes back in a cycle. Out it is always one sample.
    #[must_use]
    pub fn bytes_back(&self, cycle: Cycle) -> f64 {
        let share = match cycle {
            Cycle::Mean => self.telemetry_share(),
            Cycle::Worst => self.telemetry_share().ceil(),
        };
        TORQUE.frame_len() as f64 + share * TELEMETRY.frame_len() as f64
    }

    /// How long a torque waits for telemetry that is still on the wire when it is ready.
    fn wait_behind_telemetry(&self, period: Duration) -> Duration {
        match self.telemetry_every {
            0 => Duration::ZERO,
            _ => (self.frame(TORQUE) + self.frame(TELEMETRY)).saturating_sub(period),
        }
    }

    /// From the first bit of a sample to the last of its torque, with a drive that needs no time.
    #[must_use]
    pub fn answer(&self, cycle: Cycle) -> Duration {
        let undisturbed = self.frame(SAMPLE) + self.frame(TORQUE);
        match cycle {
            Cycle::Mean => {
                undisturbed + self.wait_behind_telemetry(self.period).mul_f64(self.telemetry_share())
            }
            Cycle::Worst => undisturbed + self.wait_behind_telemetry(self.period),
        }
    }

    /// What a period has for an answer: the loop keeps the rest for itself, see [`PERIOD_MARGIN`].
    #[must_use]
    pub fn deadline(&self) -> Duration {
        self.period - self.period / PERIOD_MARGIN
    }

    /// Whether the torque is there in time in these cycles, and nothing piles up on the wire.
    #[must_use]
    pub fn holds(&self, cycle: Cycle) -> bool {
        let back = Duration::from_secs_f64(10.0 * self.bytes_back(Cycle::Mean) / f64::from(self.baud));
        self.answer(cycle) <= self.deadline() && self.frame(SAMPLE) <= self.period && back <= self.period
    }

    /// The shortest period that [`holds`](Self::holds), to a microsecond.
    #[must_use]
    pub fn shortest_period(&self, cycle: Cycle) -> Duration {
        // Longer periods never hold less, and no cycle takes longer than this.
        let (mut short_us, mut long_us) = (0, 1 + 2_000_000_000 / u64::from(self.baud));
        while long_us - short_us > 1 {
            let middle_us = u64::midpoint(short_us, long_us);
            if (Self { period: Duration::from_micros(middle_us), ..*self }).holds(cycle) {
                long_us = middle_us;
            } else {
                short_us = middle_us;
            }
        }
        Duration::from_micros(long_us)
    }

    /// The highest control rate that [`holds`](Self::holds).
    #[must_use]
    pub fn highest_rate_hz(&self, cycle: Cycle) -> f64 {
        1.0 / self.shortest_period(cycle).as_secs_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(baud: u32, period_us: u64, telemetry_every: u16) -> Budget {
        Budget { baud, period: Duration::from_micros(period_us), telemetry_every }
    }

    #[test]
    fn a_cycle_is_made_of_the_protocol_s_frames() {
        let budget = at(1_000_000, 1_000, 10);
        assert_eq!([SAMPLE, TORQUE, TELEMETRY].map(MessageLayout::frame_len), [19, 16, 33]);
        assert!((budget.bytes_back(Cycle::Mean) - 19.3).abs() < 1e-9);
        assert_eq!(budget.bytes_back(Cycle::Worst), 49.0);
        assert_eq!(at(1_000_000, 1_000, 0).bytes_back(Cycle::Worst), 16.0);
        // Ten microseconds a byte, and the wire back is idle again when the next torque comes.
        assert_eq!(budget.answer(Cycle::Worst), Duration::from_micros(350));
    }

    #[test]
    fn telemetry_that_is_longer_than_the_rest_of_the_period_delays_the_next_torque() {
        // The wire back is taken for 490 us after the first bit of a torque, 40 us into the next one.
        let budget = at(1_000_000, 450, 10);
        assert_eq!(budget.answer(Cycle::Worst), Duration::from_micros(390));
        assert_eq!(budget.answer(Cycle::Mean), Duration::from_micros(354));
        assert!(budget.holds(Cycle::Worst), "427.5 us are there for it");
        assert!(!at(1_000_000, 420, 10).holds(Cycle::Worst), "420 us of 399");
        assert!(at(1_000_000, 420, 0).holds(Cycle::Worst));
    }

    #[test]
    fn telemetry_in_every_cycle_must_not_pile_up() {
        // Each answer alone would be in time: 35 bytes and a wait that has not grown yet.
        let budget = at(1_000_000, 485, 1);
        assert!(budget.answer(Cycle::Worst) < budget.deadline());
        assert!(!budget.holds(Cycle::Worst));
        assert_eq!(budget.shortest_period(Cycle::Worst), Duration::from_micros(490));
    }

    #[test]
    fn the_shortest_period_holds_and_a_shorter_one_does_not() {
        for (baud, every) in [(9_600, 1), (115_200, 10), (460_800, 2), (921_600, 0), (12_000_000, 10)] {
            for cycle in [Cycle::Mean, Cycle::Worst] {
                let budget = at(baud, 1, every);
                let shortest = budget.shortest_period(cycle);
                assert!(Budget { period: shortest, ..budget }.holds(cycle), "{budget:?} {shortest:?}");
                let shorter = shortest - Duration::from_micros(1);
                assert!(!Budget { period: shorter, ..budget }.holds(cycle), "{budget:?} {shorter:?}");
            }
        }
    }

    #[test]
    fn one_kilohertz_needs_460_800_bd_and_more_with_telemetry_in_every_cycle() {
        assert!(!at(115_200, 1_000, 10).holds(Cycle::Mean));
        assert!(!at(230_400, 1_000, 0).holds(Cycle::Worst));
        assert!(at(460_800, 1_000, 10).holds(Cycle::Worst));
        assert!(!at(460_800, 1_000, 1).holds(Cycle::Worst));
        assert!(at(921_600, 1_000, 1).holds(Cycle::Worst));
    }
}
