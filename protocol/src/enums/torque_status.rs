//! The status byte of a torque: the state of the drive, and flags.

use crate::enums::state::State;
use crate::layout::FieldType;
use crate::wire::Wire;

bitflags::bitflags! {
    /// Conditions of one torque.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct TorqueFlags: u8 {
        /// The drive clamped the torque of the control law to the torque limit.
        const SATURATED = 0x10;
        /// The drive had answered this sample before. The answer is the same, without a control step.
        const REPEATED = 0x20;
        /// Samples are missing between the last sample taken and this one.
        const GAP = 0x40;
    }
}

flag_set!(TorqueFlags);

/// State after a sample, and the flags of its torque, in one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TorqueStatus {
    /// State after the step; the low four bits.
    pub state: State,
    /// Flags of the torque; the high four bits.
    pub flags: TorqueFlags,
}

impl TorqueStatus {
    /// Bits of a status byte that hold the state; the others are flags.
    pub const STATE_MASK: u8 = 0x0f;

    /// State and flags in one byte.
    #[inline]
    #[must_use]
    pub const fn byte(self) -> u8 {
        (self.state.byte() & Self::STATE_MASK) | (self.flags.bits() & !Self::STATE_MASK)
    }

    /// State and flags of a byte, those without a name included; `None` for a state of 0 only.
    #[inline]
    #[must_use]
    pub const fn from_byte(byte: u8) -> Option<Self> {
        match State::from_byte(byte & Self::STATE_MASK) {
            Some(state) => {
                Some(Self { state, flags: TorqueFlags::from_bits_retain(byte & !Self::STATE_MASK) })
            }
            None => None,
        }
    }
}

const _: () = {
    assert!(TorqueFlags::all().bits() & TorqueStatus::STATE_MASK == 0, "flags lie above the state");
    let mut at = 0;
    while at < State::ALL.len() {
        assert!(State::ALL[at].byte() & !TorqueStatus::STATE_MASK == 0, "a state has four bits");
        at += 1;
    }
};

impl Wire for TorqueStatus {
    const LEN: usize = 1;
    const TYPE: FieldType = FieldType::Status { states: State::LIST, flags: TorqueFlags::SET };

    #[inline]
    fn put(self, out: &mut [u8]) {
        out[0] = self.byte();
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        Self::from_byte(bytes[0])
    }
}
