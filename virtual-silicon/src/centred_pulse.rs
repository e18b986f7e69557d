//! Pulses of a timer that counts up and down, which the models don't read.

use rigless::edge::Pulse;
use rigless::time::VirtualNanos;

use crate::chip::Chip;
use crate::tim1::{ARR, CCR1, CLOCK_MHZ, CMS, CR1, PSC};
use crate::wiring::TimerOutput;

/// The pulse that TIM1 repeats at an output, without its dead time; `None` for a level, and for a timer that counts up alone. A new
/// compare value counts from its writing on: the image writes it in the half of a period before it takes effect.
pub(crate) fn centred_pulse(chip: &mut Chip, output: TimerOutput) -> Option<Pulse> {
    let mut register = |address| chip.register_at(address, VirtualNanos(0));
    if register(CR1) & CMS == 0 {
        return None;
    }
    let (last, cycles) = (register(ARR), register(PSC) + 1);
    let high = register(CCR1 + 4 * u64::from(output.channel - 1)).min(last);
    let width = if output.is_complementary { last - high } else { high };
    let time = |counts: u64| VirtualNanos(2 * counts * cycles * 1_000 / CLOCK_MHZ);
    (width > 0 && width < last).then(|| Pulse { width: time(width), period: time(last) })
}
