//! The wire from the timer of the modulation to the converters, which the models don't draw (RM0090 13.6): TIM1 starts the injected group
//! of ADC1 when the reference of its channel 4 rises.

use rigless::time::VirtualNanos;

use crate::chip::Chip;
use crate::tim1;

/// The reference of channel 4 as trigger output.
const MMS: u64 = 0b111 << 4;
/// Bits of ADC_CR2: a rising trigger of the injected group, TIM1 as its source, and its start by software.
const JEXTEN_RISING: u64 = 0b01 << 20;
const JEXTEN: u64 = 0b11 << 20;
const JEXTSEL: u64 = 0b1111 << 16;
const JEXTSEL_TIM1: u64 = 0b0001 << 16;
const JSWSTART: u64 = 1 << 22;

/// The next trigger.
#[derive(Debug, Default)]
pub struct ConverterTrigger {
    next: Option<VirtualNanos>,
}

impl ConverterTrigger {
    /// Whether the trigger comes at this instant, the first one between two instructions from it on.
    #[must_use]
    pub fn is_due(&self, at: VirtualNanos) -> bool {
        self.next.is_some_and(|next| next <= at)
    }

    /// Starts the converters if their trigger is due. Returns the instant of the next one; `None` while the image has connected none.
    pub fn turn(&mut self, chip: &mut Chip, at: VirtualNanos) -> Option<VirtualNanos> {
        let control_register = chip.part.registers().converter_control?;
        let control = chip.register_at(control_register, at);
        if control & (JEXTEN | JEXTSEL) != JEXTEN_RISING | JEXTSEL_TIM1 {
            self.next = None;
            return None;
        }
        if self.is_due(at) {
            chip.write_register(control_register, control | JSWSTART, at);
        }
        if self.next.is_none() || self.is_due(at) {
            self.next = next_rise(chip, at);
        }
        self.next
    }
}

/// The next instant at which the counter reaches the compare value of channel 4 on its way up.
fn next_rise(chip: &mut Chip, at: VirtualNanos) -> Option<VirtualNanos> {
    let mut register = |address| chip.register_at(address, at);
    let control = register(tim1::CR1);
    if control & tim1::CEN == 0 || register(tim1::CR2) & MMS != MMS {
        return None;
    }
    let [count, prescaler, last, compare] = [tim1::CNT, tim1::PSC, tim1::ARR, tim1::CCR4].map(register);
    let is_centred = control & tim1::CMS != 0;
    let period = if is_centred { 2 * last } else { last + 1 };
    let place = if is_centred && control & tim1::DIR != 0 { period - count } else { count };
    let way = (compare + period - place) % period.max(1);
    // At the place itself the trigger has just come.
    let way = if way <= 1 { way + period } else { way };
    Some(VirtualNanos(at.0 + (way * (prescaler + 1) * 1_000).div_ceil(tim1::CLOCK_MHZ)))
}
