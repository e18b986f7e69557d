//! Device time: milliseconds counted by SysTick plus the cycles since the last of them.
//!
//! SysTick counts `RELOAD..=0` and asks for its interrupt on the step to 0, so a millisecond begins at 0. Between that
//! step and the interrupt's task the count has started over while the milliseconds haven't; the pending flag tells. We
//! read with interrupts off, so that no task can count in between:
//!
//! | count | pending | meaning |
//! |---|---|---|
//! | any | yes | a millisecond has ended that is not counted yet; the count is read again, for it may be from before |
//! | 0 | no | ended this very moment (QEMU stays at 0 until its timer has run) |
//! | other | no | within the counted millisecond |
//!
//! QEMU can be late by whole milliseconds when its host is busy, and then delivers one interrupt for several. Device
//! time lags then, but never runs backwards.

use core::cell::Cell;
use core::time::Duration;

use cortex_m::interrupt::{self, Mutex};
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use lashloop_firmware::drive::Clock;

use super::clock_tree::CORE_HZ;

const CYCLES_PER_MILLISECOND: u32 = CORE_HZ / 1_000;

static MILLISECONDS: Mutex<Cell<u64>> = Mutex::new(Cell::new(0));

/// The clock of the board, with a resolution of one cycle (6 ns). It is right for tasks up to the priority of SysTick;
/// one above could read it between SysTick's interrupt and [`Ticker::count_millisecond`].
pub(crate) struct DeviceClock(());

/// The side of SysTick's task.
pub(crate) struct Ticker(());

/// Starts SysTick.
pub(crate) fn start(mut syst: SYST) -> (DeviceClock, Ticker) {
    syst.set_clock_source(SystClkSource::Core);
    syst.set_reload(CYCLES_PER_MILLISECOND - 1);
    syst.clear_current();
    syst.enable_counter();
    syst.enable_interrupt();
    (DeviceClock(()), Ticker(()))
}

impl Ticker {
    /// Counts one millisecond, once per interrupt, and gives the device time.
    pub(crate) fn count_millisecond(&mut self) -> Duration {
        interrupt::free(|token| {
            let milliseconds = MILLISECONDS.borrow(token);
            milliseconds.set(milliseconds.get() + 1);
        });
        DeviceClock(()).now()
    }
}

impl Clock for DeviceClock {
    fn now(&self) -> Duration {
        let (milliseconds, cycles) = interrupt::free(|token| {
            let milliseconds = MILLISECONDS.borrow(token).get();
            let count = SYST::get_current();
            if SCB::is_pendst_pending() {
                (milliseconds + 1, cycles_since_zero(SYST::get_current()))
            } else if count == 0 {
                (milliseconds + 1, 0)
            } else {
                (milliseconds, cycles_since_zero(count))
            }
        });
        // 168 cycles are 1,000 ns; the product stays below 2^25.
        Duration::from_millis(milliseconds) + Duration::from_nanos(u64::from(cycles * 125 / 21))
    }
}

/// Cycles since the count was 0.
fn cycles_since_zero(count: u32) -> u32 {
    if count == 0 { 0 } else { CYCLES_PER_MILLISECOND - count }
}
