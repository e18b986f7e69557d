//! The closed lists of names both sides use.

use crate::layout::FieldType;
use crate::wire::Wire;

wire_enum! {
    /// Where the drive is in its life.
    pub enum State {
        /// Powered, not yet greeted by a host of the same protocol version. Torque is zero.
        Boot = 1,
        /// Greeted and disarmed. Torque is zero; parameters may be set.
        Idle = 2,
        /// Armed on purpose, waiting for the start. Torque is zero.
        Armed = 3,
        /// The controller gives torque.
        Running = 4,
        /// Something went wrong. Torque is zero until the fault is cleared.
        Faulted = 5,
    }
}

wire_enum! {
    /// Control laws a drive may offer.
    pub enum ControllerId {
        /// The cascade without compensation ("before").
        Pd = 1,
        /// The adaptive compensation of Merzouki and Cadiou in the reading that meets its numbers ("after").
        Merzouki = 2,
        /// The same as printed: without lead and without the free control. An ablation.
        MerzoukiAsPrinted = 3,
        /// Not the paper's: the gap inverted in the torque domain and identified by least squares.
        BacklashInverse = 4,
    }
}

impl ControllerId {
    /// Name of the law in scenarios, records and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pd => "pd",
            Self::Merzouki => "merzouki",
            Self::MerzoukiAsPrinted => "merzouki-as-printed",
            Self::BacklashInverse => "backlash-inverse",
        }
    }

    /// The law with this name, former names included; `None` for any other text.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "faithful" => Some(Self::Merzouki),
            "literal" => Some(Self::MerzoukiAsPrinted),
            "compensating" => Some(Self::BacklashInverse),
            name => Self::ALL.iter().copied().find(|law| law.name() == name),
        }
    }
}

impl core::fmt::Display for ControllerId {
    fn fmt(&self, out: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        out.pad(self.name())
    }
}

wire_enum! {
    /// Where the compensation takes the disturbing torque from: values of the parameter `disturbing_torque_source`.
    pub enum DisturbingTorqueSource {
        /// The nominal dead-zone model, equation (4); right on the paper's smooth plant only.
        Model = 1,
        /// A momentum observer on the motor side; right on any plant.
        Observed = 2,
    }
}

wire_enum! {
    /// Why the drive latched a fault.
    pub enum FaultCode {
        /// No sample within the watchdog's time. `value` and `limit` in seconds.
        Watchdog = 1,
        /// The host asked for an emergency stop.
        EmergencyStop = 2,
        /// The controller's torque was not finite.
        TorqueNotFinite = 3,
        /// The reference in a sample was not finite.
        ReferenceNotFinite = 4,
        /// The motor encoder moved faster than is plausible. `value` and `limit` in rad/s.
        MotorEncoderJump = 5,
        /// The load encoder moved faster than is plausible. `value` and `limit` in rad/s.
        LoadEncoderJump = 6,
        /// The firmware panicked. `detail` is the source line.
        Panic = 7,
        /// The processor took a fault exception, `detail` is the program counter; or an interrupt that nobody expects,
        /// `detail` is its number.
        ProcessorFault = 8,
    }
}

wire_enum! {
    /// What became of a request.
    pub enum Outcome {
        /// Done.
        Accepted = 1,
        /// Not in this state; the answer carries the state.
        WrongState = 2,
        /// The session in the request is not the one opened by the last `Hello`.
        WrongSession = 3,
        /// Host and drive speak different protocol versions.
        VersionMismatch = 4,
        /// There is no parameter with this index.
        UnknownParameter = 5,
        /// The value's type is not the parameter's.
        WrongType = 6,
        /// The value is outside the parameter's range.
        OutOfRange = 7,
        /// The sample is older than the last one taken, or too far ahead of it, or not 0 after a start.
        OutOfSequence = 8,
        /// The parameters, each in its range, don't go together; a log text says which.
        Inconsistent = 9,
    }
}

wire_enum! {
    /// Weight of a log text.
    pub enum LogLevel {
        /// Of use when looking for a cause.
        Debug = 1,
        /// Worth knowing.
        Info = 2,
        /// Works, but not as it should.
        Warning = 3,
        /// Does not work.
        Error = 4,
    }
}

wire_enum! {
    /// Type of a parameter's value.
    pub enum ParameterType {
        /// Unsigned integer, 4 bytes.
        U32 = 1,
        /// IEEE 754 binary32, 4 bytes.
        F32 = 2,
    }
}

bitflags::bitflags! {
    /// What is to be known of one torque.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct TorqueFlags: u8 {
        /// The controller asked for more than the torque limit.
        const SATURATED = 0x10;
        /// The sample had been answered before; this is the same answer again and no control step was made.
        const REPEATED = 0x20;
        /// Samples are missing between this one and the one before.
        const GAP = 0x40;
    }
}

impl TorqueFlags {
    /// Every bit with its name.
    pub const NAMES: &'static [(u16, &'static str)] =
        &[(0x10, "SATURATED"), (0x20, "REPEATED"), (0x40, "GAP")];
}

/// The state that a torque was given in, and what is to be known of the torque: both in one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TorqueStatus {
    /// State after the step; the low four bits.
    pub state: State,
    /// What is to be known of the torque; the high four bits.
    pub flags: TorqueFlags,
}

impl TorqueStatus {
    /// The bits of a status that hold the state; the others are flags.
    pub const STATE_MASK: u8 = 0x0f;

    /// State and flags in one byte.
    #[inline]
    #[must_use]
    pub const fn byte(self) -> u8 {
        self.state as u8 | self.flags.bits()
    }

    /// State and flags of a byte; `None` if it holds a state or a flag without a name.
    #[inline]
    #[must_use]
    pub const fn from_byte(byte: u8) -> Option<Self> {
        match (State::from_byte(byte & Self::STATE_MASK), TorqueFlags::from_bits(byte & !Self::STATE_MASK)) {
            (Some(state), Some(flags)) => Some(Self { state, flags }),
            _ => None,
        }
    }
}

const _: () = {
    assert!(TorqueFlags::all().bits() & TorqueStatus::STATE_MASK == 0, "flags lie above the state");
    let mut at = 0;
    while at < State::ALL.len() {
        assert!(State::ALL[at] as u8 & !TorqueStatus::STATE_MASK == 0, "a state has four bits");
        at += 1;
    }
};

impl Wire for TorqueStatus {
    const LEN: usize = 1;
    const TYPE: FieldType = FieldType::Status { states: State::NAMES, flags: TorqueFlags::NAMES };

    #[inline]
    fn put(self, out: &mut [u8]) {
        out[0] = self.byte();
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        Self::from_byte(bytes[0])
    }
}

bitflags::bitflags! {
    /// The control laws a drive offers: bit `n` stands for the [`ControllerId`] with byte `n`.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Controllers: u16 {
        /// [`ControllerId::Pd`].
        const PD = 1 << ControllerId::Pd as u16;
        /// [`ControllerId::Merzouki`].
        const MERZOUKI = 1 << ControllerId::Merzouki as u16;
        /// [`ControllerId::MerzoukiAsPrinted`].
        const MERZOUKI_AS_PRINTED = 1 << ControllerId::MerzoukiAsPrinted as u16;
        /// [`ControllerId::BacklashInverse`].
        const BACKLASH_INVERSE = 1 << ControllerId::BacklashInverse as u16;
    }
}

impl Controllers {
    /// Whether this law is offered.
    #[must_use]
    pub const fn offers(self, controller: ControllerId) -> bool {
        self.bits() & (1 << controller as u16) != 0
    }
}

impl Wire for Controllers {
    const LEN: usize = 2;
    const TYPE: FieldType = FieldType::Flags(&[
        (1 << 1, "PD"),
        (1 << 2, "MERZOUKI"),
        (1 << 3, "MERZOUKI_AS_PRINTED"),
        (1 << 4, "BACKLASH_INVERSE"),
    ]);

    #[inline]
    fn put(self, out: &mut [u8]) {
        self.bits().put(out);
    }

    /// Unknown bits are kept: a newer drive may offer laws this side has no name for.
    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        u16::get(bytes).map(Self::from_bits_retain)
    }
}

/// A parameter's value with its type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterValue {
    /// An unsigned integer.
    U32(u32),
    /// A real number.
    F32(f32),
}

impl ParameterValue {
    /// The type alone.
    #[must_use]
    pub const fn ty(self) -> ParameterType {
        match self {
            Self::U32(_) => ParameterType::U32,
            Self::F32(_) => ParameterType::F32,
        }
    }
}

impl core::fmt::Display for ParameterValue {
    fn fmt(&self, out: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::U32(value) => value.fmt(out),
            Self::F32(value) => value.fmt(out),
        }
    }
}

impl Wire for ParameterValue {
    const LEN: usize = 5;
    const TYPE: FieldType = FieldType::ParameterValue;

    #[inline]
    fn put(self, out: &mut [u8]) {
        out[0] = self.ty() as u8;
        match self {
            Self::U32(value) => value.put(&mut out[1..]),
            Self::F32(value) => value.put(&mut out[1..]),
        }
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        match ParameterType::from_byte(bytes[0])? {
            ParameterType::U32 => u32::get(&bytes[1..]).map(Self::U32),
            ParameterType::F32 => f32::get(&bytes[1..]).map(Self::F32),
        }
    }
}

/// Version of the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Version {
    /// Incompatible changes.
    pub major: u8,
    /// Additions.
    pub minor: u8,
    /// Corrections.
    pub patch: u8,
}

impl core::fmt::Display for Version {
    fn fmt(&self, out: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(out, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

impl Wire for Version {
    const LEN: usize = 3;
    const TYPE: FieldType = FieldType::Version;

    #[inline]
    fn put(self, out: &mut [u8]) {
        out.copy_from_slice(&[self.major, self.minor, self.patch]);
    }

    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        let &[major, minor, patch] = bytes else { return None };
        Some(Self { major, minor, patch })
    }
}
