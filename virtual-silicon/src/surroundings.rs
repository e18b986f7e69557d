//! What is connected to the chip.

use std::ops::ControlFlow;
use std::time::Duration;

use rigless::emulator::Access;
use rigless::image::Image;

use crate::chip::CRYSTAL_HZ;
use crate::pins::Pins;

/// What is connected to the chip. Between two instants of its choice the chip runs undisturbed.
pub trait Surroundings: Send {
    /// Acts on the chip at `chip.now()`, and returns the device time of its next turn, or why the run ends.
    ///
    /// The next turn has to be later than this one.
    fn turn(&mut self, chip: &mut Pins<'_>) -> ControlFlow<End, Duration>;

    /// Whether [`Self::bridge_changed`] is to be called. Watching costs a reading of the bridge for each
    /// write of the image.
    fn watches_bridge(&self) -> bool {
        false
    }

    /// Whether the crystal starts when the image enables it.
    fn crystal_starts(&self) -> bool {
        true
    }

    /// Frequency of the crystal, Hz.
    fn crystal_hz(&self) -> u64 {
        CRYSTAL_HZ
    }

    /// What the flash memory holds at power-up besides the image.
    fn kept(&self) -> Option<Image> {
        None
    }

    /// Whether the core has its memory protection unit. With it each access is checked, and the chip emulated at 0.6 times the speed.
    fn has_mpu(&self) -> bool {
        false
    }

    /// The bridge changed at this device time.
    fn bridge_changed(&mut self, _at: Duration, _bridge: crate::pins::Bridge) {}

    /// The core arrived at an instruction that [`Pins::watch`] watches.
    fn arrived(&mut self, _arrival: Arrival) {}

    /// The image read or wrote a register.
    fn accessed(&mut self, _at: Duration, _access: &Access) {}
}

/// An arrival of the core at a watched instruction, which it executes next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Arrival {
    /// Address of the instruction.
    pub address: u64,
    /// Device time.
    pub at: Duration,
    /// Instructions since reset.
    pub instructions: u64,
}

/// Why surroundings end a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// All is done that was to be done.
    Done,
    /// The host disconnected.
    Disconnected,
    /// The surroundings failed: a plant that left the range of finite numbers, a host that is not there.
    Failed,
}
