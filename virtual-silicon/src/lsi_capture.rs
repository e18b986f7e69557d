//! The wire from the low-speed oscillator to channel 4 of TIM5, which the models of the part lack (RM0090 18.4.20, TI4_RMP).

use rigless::device::Level;
use rigless::soc::stm32f427::Stm32f427;
use rigless::soc::stm32f427::generated::tim2;
use rigless::soc::stm32f427::peripherals::tim::Channel;
use rigless::time::VirtualNanos;

/// TIM5 among the general-purpose timers of the part.
const TIM5: usize = 3;
/// Half a period of the oscillator at its typical 32 kHz.
const HALF_PERIOD_NS: u64 = 15_625;
/// Time after a reset in which a firmware may begin to capture: it waits 0.1 s for a crystal.
const LONGEST_START_NS: u64 = 200_000_000;

/// The oscillator's wave from the reset until the firmware has captured it. No pin of a board leads to the channel.
#[derive(Debug)]
pub struct LsiCapture {
    reset_at: VirtualNanos,
    is_high: bool,
    has_captured: bool,
    /// `None` once the firmware has captured.
    next: Option<VirtualNanos>,
}

impl LsiCapture {
    /// The wave after a reset.
    #[must_use]
    pub fn after_reset(at: VirtualNanos) -> Self {
        Self { reset_at: at, is_high: false, has_captured: false, next: Some(at) }
    }

    /// Drives the edge that is due at an instant. Returns the instant of the next one.
    ///
    /// # Panics
    /// Never: a timer has four channels.
    pub fn turn(&mut self, mcu: &mut Stm32f427, at: VirtualNanos) -> Option<VirtualNanos> {
        let due = self.next?;
        if at < due {
            return Some(due);
        }
        let (_, registers) = mcu.timer(TIM5);
        let captures = tim2::ccer::CC4E.is_set(registers.get(tim2::Register::Ccer));
        if self.has_captured && !captures || at.0 > self.reset_at.0 + LONGEST_START_NS {
            self.next = None;
            return None;
        }
        self.has_captured |= captures;
        self.is_high = !self.is_high;
        let level = if self.is_high { Level::High } else { Level::Low };
        let channel = Channel::new(4).expect("a timer has channels 1 to 4");
        mcu.drive_timer(at, TIM5, |timer, registers, context| {
            timer.drive_input(channel, level, registers, context);
        });
        Some(*self.next.insert(VirtualNanos(at.0 + HALF_PERIOD_NS)))
    }
}
