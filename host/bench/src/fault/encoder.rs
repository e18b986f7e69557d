//! Faults of the encoders: between the count and the sample.

use lashloop_plant::random::Pcg64Mcg;
use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::EncoderSample;

use super::random::{stream, uniform_below};
use super::schedule::{FaultGroups, Schedule};
use crate::scenario::Scenario;
use crate::scenario::fault::{EncoderFault, Side};

/// The faults of both encoders with their state.
pub struct EncoderFaults {
    faults: Vec<ActiveFault>,
    period_s: f64,
}

struct ActiveFault {
    schedule: Schedule,
    fault: EncoderFault,
    side: Side,
    random: Pcg64Mcg,
    /// The count at which the fault began, while the fault is active.
    at_start: Option<EncoderCounts>,
    /// The count of the previous sample.
    previous: Option<EncoderCounts>,
    /// Counts lost so far, signed and with a fraction. They stay lost after the fault.
    lost_counts: f64,
}

impl EncoderFaults {
    /// The encoder faults of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let faults = FaultGroups::of(scenario).encoders.into_iter();
        let faults = faults.map(|(index, schedule, (fault, side))| ActiveFault {
            schedule,
            fault,
            side,
            random: stream(scenario, index, 0),
            at_start: None,
            previous: None,
            lost_counts: 0.0,
        });
        Self { faults: faults.collect(), period_s: scenario.run.control_period_s() }
    }

    /// Applies the faults to a sample.
    pub fn apply(&mut self, step: u32, sample: &mut EncoderSample) {
        for fault in &mut self.faults {
            let counts = match fault.side {
                Side::Motor => &mut sample.motor_counts,
                Side::Load => &mut sample.load_counts,
            };
            *counts = fault.apply(step, *counts, self.period_s);
        }
    }
}

impl ActiveFault {
    fn apply(&mut self, step: u32, counts: EncoderCounts, period_s: f64) -> EncoderCounts {
        let previous = self.previous.replace(counts).unwrap_or(counts);
        if !self.schedule.contains(step) {
            self.at_start = None;
            return self.without_lost(counts);
        }
        let at_start = *self.at_start.get_or_insert(counts);
        match self.fault {
            EncoderFault::Stuck {} => at_start,
            EncoderFault::Dead {} => EncoderCounts::default(),
            EncoderFault::Jump { counts: offset } => counts.wrapping_add(offset),
            EncoderFault::Offset { counts: offset, over_s } => {
                let active_s = f64::from(step - self.schedule.from) * period_s;
                counts.wrapping_add((f64::from(offset) * (active_s / over_s).min(1.0)) as i32)
            }
            EncoderFault::LostCounts { share } => {
                self.lost_counts += share * f64::from(counts.wrapping_sub(previous));
                self.without_lost(counts)
            }
            EncoderFault::Noise { counts: amplitude } => {
                let drawn = uniform_below(&mut self.random, 2 * amplitude as usize + 1);
                counts.wrapping_add(drawn as i32 - amplitude as i32)
            }
            EncoderFault::Reversed {} => at_start.wrapping_add(-counts.wrapping_sub(at_start)),
        }
    }

    /// Subtracts in i64: a cast of the loss to i32 would saturate where the counter wraps around.
    fn without_lost(&self, counts: EncoderCounts) -> EncoderCounts {
        EncoderCounts::wrapping(i64::from(counts.get()) - self.lost_counts as i64)
    }
}
