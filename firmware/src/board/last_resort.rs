//! The independent watchdog: resets the chip, and with it every output, if the tasks stop without a fault.
//!
//! A core that a debugger halts has stopped too. The watchdog continues, and TIM1 stops with its outputs idle, as without main
//! output enable (RM0090 17.3.21): a motor never waits at its last torque for a breakpoint to end.

use core::sync::atomic::{AtomicBool, Ordering};

use stm32f4xx_hal::pac::{DBGMCU, IWDG};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

/// Longest time between two calls of [`feed`] at the nominal 32 kHz of the oscillator, which is 17 to 47 kHz: 3.4 to
/// 9.4 ms. SysTick feeds every millisecond.
const TIMEOUT_MS: u32 = 5;

/// Polls until a new reload value is in force: five cycles of the oscillator, 0.3 ms at 17 kHz. A poll takes at least 8 cycles
/// of the core.
const ARRIVAL_POLLS: u32 = 20_000;

static IS_RUNNING: AtomicBool = AtomicBool::new(false);

/// Starts the watchdog. Only a reset stops it.
pub(super) fn start(watchdog: IWDG, debug: &DBGMCU) {
    let mut watchdog = IndependentWatchdog::new(watchdog);
    // A debugger may have set the first bit, and a reset leaves it.
    watchdog.stop_on_debug(debug, false);
    debug.apb2_fz().modify(|_, w| w.dbg_tim1_stop().set_bit());
    watchdog.start(TIMEOUT_MS.millis());
    // The reload value arrives some cycles of the oscillator after its start; until then the first timeout is 0xfff cycles, 2.8 to
    // 7.7 s.
    let _ = (0..ARRIVAL_POLLS).any(|_| !is_updating());
    watchdog.feed();
    IS_RUNNING.store(true, Ordering::Relaxed);
}

/// Whether prescaler or reload value is on its way to the oscillator's side.
fn is_updating() -> bool {
    // SAFETY: reading the status has no effect.
    #[allow(unsafe_code)]
    let watchdog = unsafe { IWDG::steal() };
    watchdog.sr().read().bits() != 0
}

/// Whether a halt has to feed the watchdog.
pub(super) fn is_running() -> bool {
    IS_RUNNING.load(Ordering::Relaxed)
}

/// Restarts the timeout; without effect before [`start`].
pub(super) fn feed() {
    if is_running() {
        // SAFETY: after the start this store is the only access to the registers.
        #[allow(unsafe_code)]
        let watchdog = unsafe { IWDG::steal() };
        watchdog.kr().write(|w| w.key().feed());
    }
}
