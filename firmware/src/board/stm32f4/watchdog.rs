//! The independent watchdog, see `last_resort`.

use stm32f4xx_hal::pac::{DBGMCU, IWDG};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use crate::board::parts::{WATCHDOG_MS, WATCHDOG_POLLS};

/// Starts the watchdog.
pub(super) fn start(watchdog: IWDG, debug: &DBGMCU) {
    let mut watchdog = IndependentWatchdog::new(watchdog);
    // A debugger may have set the first bit, and a reset leaves it.
    watchdog.stop_on_debug(debug, false);
    debug.apb2_fz().modify(|_, w| w.dbg_tim1_stop().set_bit());
    watchdog.start(WATCHDOG_MS.millis());
    // The reload value arrives some cycles of the oscillator after its start; until then the first timeout is 0xfff cycles, 2.8 to
    // 7.7 s.
    let _ = (0..WATCHDOG_POLLS).any(|_| !is_updating());
    watchdog.feed();
}

/// Whether prescaler or reload value is on its way to the oscillator's side.
fn is_updating() -> bool {
    // SAFETY: reading the status has no effect.
    #[allow(unsafe_code)]
    let watchdog = unsafe { IWDG::steal() };
    watchdog.sr().read().bits() != 0
}
