//! The independent watchdog, see `last_resort`.

use stm32h7xx_hal::pac::{DBGMCU, IWDG};

use crate::board::parts::{WATCHDOG_MS, WATCHDOG_POLLS};

/// Counts of the oscillator's nominal 32 kHz, divided by 4.
const RELOAD: u16 = (WATCHDOG_MS * 32 / 4 - 1) as u16;

/// Starts the watchdog.
pub(super) fn start(watchdog: &IWDG, debug: &DBGMCU) {
    // A debugger may have set the first bit, and a reset leaves it.
    debug.apb4fz1.modify(|_, w| w.dbg_iwdg1().clear_bit());
    debug.apb2fz1.modify(|_, w| w.dbg_tim1().set_bit());
    watchdog.kr.write(|w| w.key().start());
    watchdog.kr.write(|w| w.key().enable());
    watchdog.pr.write(|w| w.pr().divide_by4());
    watchdog.rlr.write(|w| w.rl().bits(RELOAD));
    // Both arrive some cycles of the oscillator later; until then the first timeout is 0xfff counts, 0.35 to 1 s.
    let _ = (0..WATCHDOG_POLLS).any(|_| watchdog.sr.read().bits() == 0);
    watchdog.kr.write(|w| w.key().reset());
}
