//! The monitor of the tick: a timer counts from the start of every tick, and the power stage is off 1.5 periods later unless the next
//! tick restarts it.
//!
//! The timer is not that of the tick, and its task preempts all others. So neither a tick that stops nor a step that never
//! ends leaves the power stage on.

use super::Fitted;
use super::chip::Chip;
use super::parts::{PeriodTimer as _, StageLines as _};

/// Owned by the task of TIM2, and by that of the tick.
pub struct TickMonitor(<Fitted as Chip>::Monitor);

impl TickMonitor {
    /// The monitor before the first tick, which sets the limit.
    pub(super) fn new(timer: <Fitted as Chip>::Monitor) -> Self {
        Self(timer)
    }

    /// Counts from 0 to this limit.
    pub(super) fn restart(&mut self, limit_us: u32) {
        self.0.restart(limit_us);
    }

    /// Switches the power stage off. To be called at every interrupt; without ticks there is another one after each limit.
    pub fn trip(&mut self) {
        self.0.clear();
        <Fitted as Chip>::StageLines::switch_off();
    }
}
