//! Faults of the encoders: between the count and the sample.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::EncoderSample;
use rand_pcg::Pcg64Mcg;

use super::{Schedule, at_place, draw_below, random_stream};
use crate::scenario::Scenario;
use crate::scenario::fault::{FaultKind, Place, Side};

/// The faults of the encoders, with what they remember.
pub struct SensorFaults {
    faults: Vec<SensorFault>,
    period_s: f64,
}

struct SensorFault {
    schedule: Schedule,
    kind: FaultKind,
    side: Side,
    random: Pcg64Mcg,
    /// The count when the fault began.
    at_start: Option<EncoderCounts>,
    /// The last count that came in.
    before: Option<EncoderCounts>,
    /// Counts lost so far, with sign and fraction. They stay lost.
    lost: f64,
}

impl SensorFaults {
    /// Those of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let faults = at_place(scenario, Place::Sensor).filter_map(|(number, schedule, kind)| {
            let random = random_stream(scenario, number, 0);
            let side = side_of(&kind)?;
            Some(SensorFault { schedule, kind, side, random, at_start: None, before: None, lost: 0.0 })
        });
        Self { faults: faults.collect(), period_s: scenario.run.control_period_s() }
    }

    /// What the drive gets to see of a sample.
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

impl SensorFault {
    fn apply(&mut self, step: u32, counts: EncoderCounts, period_s: f64) -> EncoderCounts {
        let before = self.before.replace(counts).unwrap_or(counts);
        if !self.schedule.contains(step) {
            self.at_start = None;
            return self.without_lost(counts);
        }
        let at_start = *self.at_start.get_or_insert(counts);
        match self.kind {
            FaultKind::EncoderStuck { .. } => at_start,
            FaultKind::EncoderDead { .. } => EncoderCounts::default(),
            FaultKind::EncoderJump { counts: jump, .. } => counts.wrapping_add(jump),
            FaultKind::EncoderOffset { counts: offset, over_s, .. } => {
                let for_s = f64::from(step - self.schedule.from) * period_s;
                counts.wrapping_add((f64::from(offset) * (for_s / over_s).min(1.0)) as i32)
            }
            FaultKind::EncoderLostCounts { share, .. } => {
                self.lost += share * f64::from(counts.wrapping_sub(before));
                self.without_lost(counts)
            }
            FaultKind::EncoderNoise { counts: noise, .. } => {
                let drawn = draw_below(&mut self.random, 2 * noise as usize + 1);
                counts.wrapping_add(drawn as i32 - noise as i32)
            }
            FaultKind::EncoderReversed { .. } => at_start.wrapping_add(-counts.wrapping_sub(at_start)),
            _ => counts,
        }
    }

    /// Through i64, because a cast to i32 would stop at the end of its range instead of wrapping.
    fn without_lost(&self, counts: EncoderCounts) -> EncoderCounts {
        EncoderCounts::wrapping(i64::from(counts.get()) - self.lost as i64)
    }
}

fn side_of(kind: &FaultKind) -> Option<Side> {
    match kind {
        FaultKind::EncoderStuck { side }
        | FaultKind::EncoderDead { side }
        | FaultKind::EncoderJump { side, .. }
        | FaultKind::EncoderOffset { side, .. }
        | FaultKind::EncoderLostCounts { side, .. }
        | FaultKind::EncoderNoise { side, .. }
        | FaultKind::EncoderReversed { side } => Some(*side),
        _ => None,
    }
}
