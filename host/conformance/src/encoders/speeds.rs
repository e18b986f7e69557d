//! Speed limits: the last count that passes and the first that is a fault.

use super::setup::{OTHER, ROUNDING, SLOWEST, Scale};
use crate::prelude::checks::*;
use crate::reactions::fault_answer_with;

/// Periods of the longer of two tested distances.
const GAP: u16 = 11;
/// First readings, in counts: at zero, and where the movement wraps around.
const STARTS: [i64; 3] = [0, EncoderCounts::MAX.get() as i64, EncoderCounts::MIN.get() as i64];

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R7.5 R7.14 R7.15", "an encoder within its speed limit is accepted", |client| {
            let setup = Setup::coarse(client)?;
            for encoder in Encoder::BOTH {
                for (start, sign) in STARTS.into_iter().flat_map(|start| [(start, 1), (start, -1)]) {
                    client.reset()?;
                    setup.start(client)?;
                    accepted(client, placed(encoder, 0, start), NONE)?;
                    let mut at = start;
                    let mut sequence = 0;
                    // From zero often enough to show a count that adds up.
                    let more = if start == 0 { 9 } else { 0 };
                    for periods in std::iter::repeat_n(1, more).chain(periods(&setup)) {
                        at += sign * setup.scale(encoder).most_counts(periods);
                        sequence += periods;
                        accepted(client, placed(encoder, sequence, at), gap_flag(periods))?;
                    }
                }
            }
            Ok(())
        }),
        check("R7.14", "one count is never a jump", |client| {
            let setup = Setup::of(client, &SLOWEST)?;
            setup.start(client)?;
            first_sample(client)?;
            for (sequence, counts) in [(1, 1), (2, 0), (3, -1), (4, 0)] {
                let mut sample = placed(Encoder::MOTOR, sequence, counts);
                *(Encoder::LOAD.counts_mut)(&mut sample) = EncoderCounts::wrapping(-counts);
                accepted(client, sample, NONE)?;
            }
            Ok(())
        }),
    ];
    checks.extend(Encoder::BOTH.into_iter().map(|encoder| {
        let name = format!("a {} encoder that jumps is a fault", encoder.name);
        check("R5.2 R7.14 R7.16 R9.6 R9.12", name, move |client| {
            // Other settings have another effect, in the next run too.
            jump(client, &Setup::of(client, &OTHER)?, encoder, Jump { start: 0, sign: 1, periods: 1 })?;
            let setup = Setup::coarse(client)?;
            client.command(ClearFault {})?;
            jump(client, &setup, encoder, Jump { start: 0, sign: 1, periods: 1 })?;
            for periods in periods(&setup) {
                for (start, sign) in [(0, 1), (0, -1), (STARTS[1], 1), (STARTS[2], -1)] {
                    client.reset()?;
                    jump(client, &setup, encoder, Jump { start, sign, periods })?;
                }
            }
            Ok(())
        })
    }));
    checks
}

/// The distances in periods that a drive with this setup accepts.
fn periods(setup: &Setup) -> impl Iterator<Item = u16> + use<> {
    let longest = setup.longest_gap();
    [1, GAP].into_iter().filter(move |periods| *periods <= longest)
}

fn gap_flag(periods: u16) -> TorqueFlags {
    if periods > 1 { TorqueFlags::GAP } else { NONE }
}

/// A movement beyond the speed limit.
struct Jump {
    start: i64,
    sign: i64,
    periods: u16,
}

impl Scale {
    /// Most counts over `periods` that pass on any drive, one count of quantisation included.
    pub(super) fn most_counts(&self, periods: u16) -> i64 {
        (f64::from(periods) * self.counts_per_period() * (1.0 - ROUNDING)) as i64 + 1
    }

    /// Fewest counts over `periods` that no drive accepts. Skips the check if no reading shows them.
    fn fewest_counts(&self, periods: u16) -> Result<i64, Failure> {
        let counts = (f64::from(periods) * self.counts_per_period() * (1.0 + ROUNDING)) as i64 + 2;
        if counts > i64::from(EncoderCounts::MAX.get()) {
            return skip("not run: no reading exceeds the lowest speed limit of this drive");
        }
        Ok(counts)
    }

    /// A movement far beyond the speed limit in one period.
    pub(crate) fn jump_counts(&self) -> Result<i64, Failure> {
        let most = i64::from(EncoderCounts::MAX.get());
        self.fewest_counts(1).map(|fewest| (2 * fewest).min(most))
    }
}

fn jump(client: &mut Client, setup: &Setup, encoder: Encoder, jump: Jump) -> RuleResult {
    let Jump { start, sign, periods } = jump;
    let scale = setup.scale(encoder);
    let counts = scale.fewest_counts(periods)?;
    setup.start(client)?;
    // Two slow steps, and then the jump.
    for (sequence, from) in [(0, start), (1, start + sign), (2, start)] {
        accepted(client, placed(encoder, sequence, from), NONE)?;
    }
    let sequence = 2 + periods;
    let answers = client.request(placed(encoder, sequence, start + sign * counts))?;
    let it = fault_answer_with(&answers, encoder.jump_fault, gap_flag(periods))?;
    let what = format!("{} from {start} by {} counts in {periods} periods", encoder.name, sign * counts);
    let limit_rad_s = scale.speed_limit_rad_s;
    expect(it.limit == limit_rad_s, format!("{what}: the limit {limit_rad_s} rad/s"), it.limit)?;
    let speed_rad_s = (counts - 1) as f64 / f64::from(periods) * scale.speed_per_count_rad_s();
    let near = (f64::from(it.value) - speed_rad_s).abs() <= 2.0 * ROUNDING * speed_rad_s;
    expect(near, format!("{what}: the least speed, {speed_rad_s} rad/s"), it.value)?;
    still_reported(client, it)?;
    no_torque(client, sequence, Faulted)?;
    no_torque(client, sequence + 1, Faulted)
}
