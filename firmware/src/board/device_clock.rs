//! Device time: milliseconds counted by SysTick, plus the cycles since the last millisecond.
//!
//! SysTick counts down to 0 and raises its interrupt on the step to 0, so a millisecond begins at 0. Between that step
//! and the interrupt's task the count has restarted and the millisecond is not yet counted; the pending flag marks this
//! interval. The count is then read again, because the first value may be from before the step. Interrupts are off
//! throughout, so that no task can count in between.
//!
//! A millisecond is lost if the task of SysTick is delayed by more than one: never on silicon, but in QEMU on a busy
//! host. Device time lags then. Device time never runs backwards.

use core::cell::Cell;
use core::time::Duration;

use crate::drive::Clock;
use cortex_m::interrupt::{self, Mutex};
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};

use super::last_resort;
use super::parts::CORE_HZ;

const CYCLES_PER_MILLISECOND: u32 = CORE_HZ / 1_000;

/// State of the clock.
struct Memory {
    counted: Cell<Counted>,
    /// The latest time returned.
    latest: Cell<Duration>,
}

/// Milliseconds counted, in two parts because the core divides 64-bit numbers in software.
#[derive(Clone, Copy)]
struct Counted {
    seconds: u64,
    milliseconds: u32,
}

impl Counted {
    fn plus_millisecond(self) -> Self {
        match self.milliseconds {
            999 => Self { seconds: self.seconds + 1, milliseconds: 0 },
            milliseconds => Self { milliseconds: milliseconds + 1, ..self },
        }
    }
}

static MEMORY: Mutex<Memory> = Mutex::new(Memory {
    counted: Cell::new(Counted { seconds: 0, milliseconds: 0 }),
    latest: Cell::new(Duration::ZERO),
});

/// The clock of the board, with a resolution of one cycle (6 ns). Valid for tasks up to the priority of SysTick: a task
/// above could read the clock between SysTick's interrupt and [`Ticker::count_millisecond`].
#[derive(Clone, Copy)]
pub struct DeviceClock(());

/// The counter, owned by SysTick's task.
pub struct Ticker(());

/// Starts SysTick.
pub(crate) fn start(mut syst: SYST) -> (DeviceClock, Ticker) {
    syst.set_clock_source(SystClkSource::Core);
    syst.set_reload(CYCLES_PER_MILLISECOND - 1);
    syst.clear_current();
    syst.enable_counter();
    syst.enable_interrupt();
    (DeviceClock(()), Ticker(()))
}

/// Device time for a handler that has no clock; zero before the start. Interrupts may be off.
pub(super) fn now() -> Duration {
    DeviceClock(()).now()
}

impl Ticker {
    /// Counts one millisecond and returns the device time. To be called once per interrupt.
    pub fn count_millisecond(&mut self) -> Duration {
        last_resort::feed();
        interrupt::free(|token| {
            let counted = &MEMORY.borrow(token).counted;
            counted.set(counted.get().plus_millisecond());
        });
        DeviceClock(()).now()
    }
}

impl Clock for DeviceClock {
    fn now(&self) -> Duration {
        interrupt::free(|token| {
            let memory = MEMORY.borrow(token);
            let mut counted = memory.counted.get();
            let mut count = SYST::get_current();
            if SCB::is_pendst_pending() {
                counted = counted.plus_millisecond();
                count = SYST::get_current();
            }
            const { assert!(CORE_HZ == 168_000_000) };
            // 168 cycles are 1,000 ns; the product stays below 2^25.
            let nanoseconds = cycles_since_zero(count) * 125 / 21;
            let now = Duration::new(counted.seconds, counted.milliseconds * 1_000_000 + nanoseconds);
            let now = now.max(memory.latest.get());
            memory.latest.set(now);
            now
        })
    }
}

/// Cycles since the count was 0.
fn cycles_since_zero(count: u32) -> u32 {
    if count == 0 { 0 } else { CYCLES_PER_MILLISECOND - count }
}
