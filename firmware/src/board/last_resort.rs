//! The independent watchdog: resets the chip, and with it every output, if the tasks stop without a fault.
//!
//! A core that a debugger halts has stopped too. The watchdog continues, and the timer of the power stage stops with its outputs
//! idle, as without main output enable (RM0090 17.3.21): a motor never waits at its last torque for a breakpoint to end.

use core::sync::atomic::{AtomicBool, Ordering};

use super::Fitted;
use super::chip::Chip as _;

/// Longest time between two calls of [`feed`] at the nominal 32 kHz of the oscillator, which is 17 to 47 kHz: 3.4 to
/// 9.4 ms. SysTick feeds every millisecond.
pub(super) const TIMEOUT_MS: u32 = 5;

/// Polls until a new reload value is in force: five cycles of the oscillator, 0.3 ms at 17 kHz. A poll takes at least 8 cycles
/// of the core.
pub(super) const ARRIVAL_POLLS: u32 = 20_000;

static IS_RUNNING: AtomicBool = AtomicBool::new(false);

/// The watchdog runs. Only a reset stops it.
pub(super) fn note_start() {
    IS_RUNNING.store(true, Ordering::Relaxed);
}

/// Whether a halt has to feed the watchdog.
pub(super) fn is_running() -> bool {
    IS_RUNNING.load(Ordering::Relaxed)
}

/// Restarts the timeout; without effect before the start.
pub(super) fn feed() {
    if is_running() {
        Fitted::feed_watchdog();
    }
}
