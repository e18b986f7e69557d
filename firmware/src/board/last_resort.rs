//! The independent watchdog: resets the chip, and with it every output, if the tasks stop without a fault.
//!
//! A core that a debugger halts has stopped too. The watchdog continues, and the timer of the power stage stops with its outputs
//! idle, as without main output enable (RM0090 17.3.21): a motor never waits at its last torque for a breakpoint to end.

use core::sync::atomic::{AtomicBool, Ordering};

use super::Fitted;
use super::chip::Chip as _;

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
