//! What the tick and the current loop of a bridge tell each other.
//!
//! Neither waits for the other: they exchange a few words at a time, within some cycles with interrupts masked.

use core::cell::Cell;

use cortex_m::interrupt::{Mutex, free};

use crate::power_stage::{Modulation, PowerStageFault};

/// A run that the loop controls.
#[derive(Clone, Copy)]
pub(super) struct BridgeRun {
    pub(super) modulation: Modulation,
    /// High time of a duty of 1, in counts of the timer.
    pub(super) period_counts: u16,
}

/// A torque in N m at a speed in rad/s.
#[derive(Clone, Copy)]
pub(super) struct BridgeCommand {
    pub(super) torque_nm: f32,
    pub(super) speed_rad_s: f32,
}

const NO_TORQUE: BridgeCommand = BridgeCommand { torque_nm: 0.0, speed_rad_s: 0.0 };

/// A value that each side may read and write.
pub(super) struct Shared<T>(Mutex<Cell<T>>);

impl<T: Copy> Shared<T> {
    const fn new(value: T) -> Self {
        Self(Mutex::new(Cell::new(value)))
    }

    pub(super) fn get(&self) -> T {
        free(|section| self.0.borrow(section).get())
    }

    pub(super) fn set(&self, value: T) {
        free(|section| self.0.borrow(section).set(value));
    }

    /// Takes the value and leaves another one.
    fn replace(&self, value: T) -> T {
        free(|section| self.0.borrow(section).replace(value))
    }
}

pub(super) static RUN: Shared<Option<BridgeRun>> = Shared::new(None);
pub(super) static COMMAND: Shared<BridgeCommand> = Shared::new(NO_TORQUE);
/// Sums of measured torque and voltage of the bridge in N m and V, and their number, since the tick took them.
pub(super) static MEASURED: Shared<([f32; 2], u32)> = Shared::new(NOT_MEASURED);
const NOT_MEASURED: ([f32; 2], u32) = ([0.0; 2], 0);
pub(super) static FAULT: Shared<Option<PowerStageFault>> = Shared::new(None);
/// Whether the sensor's offset is plausible; `None` until it is known.
pub(super) static OFFSET_IS_PLAUSIBLE: Shared<Option<bool>> = Shared::new(None);

/// Whether the bus had a voltage when it was last read with the bridge off.
pub(super) static HAS_BUS: Shared<bool> = Shared::new(true);

/// Begins a run at no torque. The bridge is still off.
pub(super) fn begin(modulation: Modulation, period_counts: u16) {
    COMMAND.set(NO_TORQUE);
    MEASURED.set(NOT_MEASURED);
    FAULT.set(None);
    RUN.set(Some(BridgeRun { modulation, period_counts }));
}

/// The mean torque in N m and voltage in V since the last call; `None` without a measurement.
pub(super) fn take_measured() -> Option<[f32; 2]> {
    let (sums, count) = MEASURED.replace(NOT_MEASURED);
    (count > 0).then(|| sums.map(|sum| sum / count as f32))
}

/// A fault that switched the bridge off since the last call.
pub(super) fn take_fault() -> Option<PowerStageFault> {
    FAULT.replace(None)
}
