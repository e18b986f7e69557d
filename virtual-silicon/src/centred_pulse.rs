//! Pulses of a timer that counts up and down, which the models don't read.

use rigless::edge::Pulse;
use rigless::time::VirtualNanos;

use crate::chip::Chip;
use crate::tim1::{ARR, CCR1, CLOCK_MHZ, CMS, CR1, PSC};
use crate::wiring::TimerOutput;

/// The period of TIM1 while it counts up and down.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CentredPeriod {
    /// The last count.
    last: u64,
    /// Cycles of a count.
    cycles: u64,
}

impl CentredPeriod {
    /// The present period; `None` for a timer that counts up alone.
    pub(crate) fn of(chip: &mut Chip) -> Option<Self> {
        if register(chip, CR1) & CMS == 0 {
            return None;
        }
        Some(Self { last: register(chip, ARR), cycles: register(chip, PSC) + 1 })
    }

    /// The pulse that TIM1 repeats at an output, without its dead time; `None` for a level. A new compare value counts from its writing
    /// on: the image writes it in the half of a period before it takes effect.
    pub(crate) fn pulse(self, chip: &mut Chip, output: TimerOutput) -> Option<Pulse> {
        let Self { last, cycles } = self;
        let high = register(chip, CCR1 + 4 * u64::from(output.channel - 1)).min(last);
        let width = if output.is_complementary { last - high } else { high };
        let time = |counts: u64| VirtualNanos(2 * counts * cycles * 1_000 / CLOCK_MHZ);
        (width > 0 && width < last).then(|| Pulse { width: time(width), period: time(last) })
    }
}

fn register(chip: &mut Chip, address: u64) -> u64 {
    chip.register_at(address, VirtualNanos(0))
}
