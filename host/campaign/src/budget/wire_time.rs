//! The time that frames take on a serial line, per control cycle.
//!
//! Ten bits per byte, full duplex, and no time for computation: these times are the lower bound for the line. In a cycle the
//! sample goes out, the torque comes back, and telemetry follows every n-th torque. Telemetry still on the wire when the
//! next torque is ready delays it:
//!
//! ```text
//! out   |sample|                      |sample|
//! back         |torque|    telemetry         |torque|
//! ```
//!
//! Frame lengths come from the protocol's layouts.

use std::time::Duration;

use lashloop_protocol::layout::MessageLayout;
use lashloop_protocol::message::{EncoderSample, Telemetry, TorqueAnswer};
use lashloop_protocol::wire::Payload;

use lashloop_bench::run::real_time::PERIOD_MARGIN;
use lashloop_link::uart_model::transmission_time;

/// Host to drive, in every period.
pub const SAMPLE: &MessageLayout = &EncoderSample::LAYOUT;
/// Drive to host, in every period.
pub const TORQUE: &MessageLayout = &TorqueAnswer::LAYOUT;
/// Drive to host, after every n-th torque.
pub const TELEMETRY: &MessageLayout = &Telemetry::LAYOUT;

/// Speeds of common adapters, in bit/s.
pub const USUAL_BAUD: [u32; 11] = [
    115_200, 230_400, 460_800, 921_600, 1_000_000, 1_500_000, 2_000_000, 3_000_000, 4_000_000, 6_000_000,
    12_000_000,
];

/// A line and its load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Budget {
    /// In bit/s.
    pub baud: u32,
    /// Control period.
    pub period: Duration,
    /// Torques per telemetry frame; 0 for no telemetry.
    pub telemetry_every: u16,
    /// Signals that telemetry carries, at most 13; 0 for no telemetry.
    pub signals: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cycle {
    /// The average over all cycles.
    Mean,
    /// The cycle with telemetry, and the torque after it.
    Worst,
}

impl Budget {
    /// Time of a frame on the wire.
    #[must_use]
    pub fn frame(&self, layout: &MessageLayout) -> Duration {
        transmission_time(layout.frame_len() as u64, self.baud)
    }

    /// Length of a telemetry frame in bytes; 0 without telemetry.
    #[must_use]
    pub fn telemetry_len(&self) -> usize {
        if self.telemetry_every == 0 { 0 } else { TELEMETRY.frame_len_of(self.signals).unwrap_or(0) }
    }

    /// Telemetry frames per torque, 0 to 1.
    fn telemetry_rate(&self) -> f64 {
        if self.telemetry_len() == 0 { 0.0 } else { 1.0 / f64::from(self.telemetry_every) }
    }

    /// Bytes from drive to host in a cycle. The other direction carries one sample.
    #[must_use]
    pub fn bytes_back(&self, cycle: Cycle) -> f64 {
        let rate = match cycle {
            Cycle::Mean => self.telemetry_rate(),
            Cycle::Worst => self.telemetry_rate().ceil(),
        };
        TORQUE.frame_len() as f64 + rate * self.telemetry_len() as f64
    }

    /// Delay of a torque by telemetry still on the wire.
    fn wait_behind_telemetry(&self, period: Duration) -> Duration {
        match self.telemetry_len() {
            0 => Duration::ZERO,
            len => (self.frame(TORQUE) + transmission_time(len as u64, self.baud)).saturating_sub(period),
        }
    }

    /// Time from the first bit of a sample to the last bit of its torque, without computation in the drive.
    #[must_use]
    pub fn answer(&self, cycle: Cycle) -> Duration {
        let undisturbed = self.frame(SAMPLE) + self.frame(TORQUE);
        match cycle {
            Cycle::Mean => {
                undisturbed + self.wait_behind_telemetry(self.period).mul_f64(self.telemetry_rate())
            }
            Cycle::Worst => undisturbed + self.wait_behind_telemetry(self.period),
        }
    }

    /// Time for an answer within a period; the loop reserves the rest, see [`PERIOD_MARGIN`].
    #[must_use]
    pub fn deadline(&self) -> Duration {
        self.period - self.period / PERIOD_MARGIN
    }

    /// Whether the torque meets its deadline in these cycles, and neither direction is overloaded.
    #[must_use]
    pub fn holds(&self, cycle: Cycle) -> bool {
        let back = Duration::from_secs_f64(10.0 * self.bytes_back(Cycle::Mean) / f64::from(self.baud));
        self.answer(cycle) <= self.deadline() && self.frame(SAMPLE) <= self.period && back <= self.period
    }

    /// The shortest period that [`holds`](Self::holds), in steps of 1 us.
    #[must_use]
    pub fn shortest_period(&self, cycle: Cycle) -> Duration {
        // `holds` is monotonic in the period, and no cycle takes longer than the upper bound.
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
        Budget { baud, period: Duration::from_micros(period_us), telemetry_every, signals: 6 }
    }

    #[test]
    fn cycle_consists_of_the_protocol_s_frames() {
        let budget = at(1_000_000, 1_000, 10);
        assert_eq!([SAMPLE, TORQUE].map(MessageLayout::frame_len), [19, 16]);
        let lengths = [0, 1, 6, 13, 14].map(|signals| Budget { signals, ..budget }.telemetry_len());
        assert_eq!(lengths, [0, 13, 33, 61, 0]);
        assert!((budget.bytes_back(Cycle::Mean) - 19.3).abs() < 1e-9);
        assert_eq!(budget.bytes_back(Cycle::Worst), 49.0);
        assert_eq!(at(1_000_000, 1_000, 0).bytes_back(Cycle::Worst), 16.0);
        // 10 us per byte, and the line is idle again before the next torque.
        assert_eq!(budget.answer(Cycle::Worst), Duration::from_micros(350));
    }

    #[test]
    fn telemetry_beyond_the_period_delays_the_next_torque() {
        // Torque and telemetry occupy the line for 490 us, 40 us into the next torque.
        let budget = at(1_000_000, 450, 10);
        assert_eq!(budget.answer(Cycle::Worst), Duration::from_micros(390));
        assert_eq!(budget.answer(Cycle::Mean), Duration::from_micros(354));
        assert!(budget.holds(Cycle::Worst), "427.5 us are there for it");
        assert!(!at(1_000_000, 420, 10).holds(Cycle::Worst), "420 us of 399");
        assert!(at(1_000_000, 420, 0).holds(Cycle::Worst));
    }

    #[test]
    fn telemetry_in_every_cycle_must_fit_the_period() {
        // A single answer would meet its deadline: 35 bytes, and a delay that has not accumulated yet.
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
    fn one_kilohertz_needs_460_800_bd_or_more() {
        assert!(!at(115_200, 1_000, 10).holds(Cycle::Mean));
        assert!(!at(230_400, 1_000, 0).holds(Cycle::Worst));
        assert!(at(460_800, 1_000, 10).holds(Cycle::Worst));
        assert!(!at(460_800, 1_000, 1).holds(Cycle::Worst));
        assert!(at(921_600, 1_000, 1).holds(Cycle::Worst));
    }
}
