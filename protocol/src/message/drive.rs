//! The messages of the drive.
//!
//! | kind | message | frame bytes | when |
//! |---|---|---|---|
//! | `0x81` | [`Identity`] | 55 to 59 | answers `Hello` |
//! | `0x82` | [`ParameterDescription`] | 64 | answers `DescribeParameter` |
//! | `0x83` | [`ParameterReport`] | 20 to 24 | answers `GetParameter` and `SetParameter` |
//! | `0x84` | [`LineReport`] | 24 to 28 | answers `Stop`, before its `CommandResult` |
//! | `0x85` | [`CommandResult`] | 15 to 19 | answers every other request, and a sample that the drive rejects |
//! | `0x86` | [`LawDescription`] | 37 | answers `DescribeLaw` |
//! | `0x87` | [`SignalDescription`] | 53 | answers `DescribeSignal` |
//! | `0x88` | [`ChoiceDescription`] | 38 | answers `DescribeChoice` |
//! | `0x89` | [`CaptureRows`] | 16 to 64 | answers `ReadCapture` |
//! | `0x90` | [`TorqueAnswer`] | 16 | answers `EncoderSample`, before any other message that the sample causes |
//! | `0x91` | [`Telemetry`] | 13 to 61 | after every n-th torque while running, if the host subscribed |
//! | `0x92` | [`FaultReport`] | 22 to 26 | when the drive latches a fault, and after an `Identity` while a fault is latched |
//! | `0x93` | [`Log`] | 60 to 64 | any time |
//! | `0x95` | [`BenchSample`] | 26 | after every n-th control step of bench mode |

use crate::counts::EncoderCounts;
use crate::enums::{
    Capabilities, FaultCode, LogLevel, Outcome, ParameterFlags, ParameterValue, State, TorqueStatus, Version,
};
use crate::telemetry_values::TelemetryValues;
use crate::text::{ChoiceName, LawName, ParameterName, SignalName, Text, UnitName};

messages! {
    /// A message of the drive.
    pub enum DriveMessage: DriveToHost, in every period TorqueAnswer;

    /// Identity of the drive. Same layout in every protocol version.
    0x81 Identity {
        /// Protocol version of the drive.
        protocol_version: u8,
        /// Minor version of the drive.
        minor_version: u8,
        /// Session of the `Hello` that this message answers.
        session: u32,
        /// Version of the firmware.
        firmware: Version,
        /// First 32 bits of the commit the firmware was built from; 0 if unknown.
        build_id: u32,
        /// 0 if the firmware was built from exactly that commit; 1 if the sources had changes, or if that is unknown.
        dirty: u8,
        /// State after the handshake.
        state: State,
        /// Name of the board.
        board: Text<16>,
        /// Control period in force, in us.
        period_us: u32,
        /// Resolution of the motor encoder in force, in counts per revolution.
        motor_counts_per_rev: u32,
        /// Resolution of the load encoder in force, in counts per revolution.
        load_counts_per_rev: u32,
        /// Number of control laws, 1 to 16.
        law_count: u8,
        /// Number of signals, 0 to 32.
        signal_count: u8,
        /// Number of parameters, 0 to 240.
        parameter_count: u8,
        /// What the drive can do beyond what every drive must.
        capabilities: Capabilities,
        /// Device time of the message, in us; wraps around. Absent if the drive has no clock.
        device_time_us: Option<u32>,
    }

    /// Name, unit, type, range, flags and laws of a parameter.
    0x82 ParameterDescription {
        /// Index of the parameter.
        index: u8,
        /// Whether it may be set while running, and whether its values have names.
        flags: ParameterFlags,
        /// Laws that the parameter belongs to: bit `n` stands for the law with index `n`. A parameter of the drive itself
        /// belongs to all laws.
        laws: u16,
        /// Value after power-up.
        default: ParameterValue,
        /// Smallest value accepted.
        min: ParameterValue,
        /// Largest value accepted.
        max: ParameterValue,
        /// Name, with the unit as its suffix.
        name: ParameterName,
        /// Unit as text; empty for a pure number.
        unit: UnitName,
    }

    /// The value of a parameter after a get or a set.
    0x83 ParameterReport {
        /// Index of the parameter.
        index: u8,
        /// Outcome of the request; unless accepted, `value` is unchanged.
        outcome: Outcome,
        /// The value in force.
        value: ParameterValue,
        /// State of the drive.
        state: State,
        /// Further detail, as defined by the outcome; else 0.
        detail: u32,
        /// Device time of the message, in us; wraps around. Absent if the drive has no clock.
        device_time_us: Option<u32>,
    }

    /// Receive statistics of the drive since the start of the run.
    0x84 LineReport {
        /// Messages received, those of unknown kinds included.
        messages: u32,
        /// Damaged frames.
        damaged: u32,
        /// Whole frames that the drive refused.
        refused: u32,
        /// Bytes lost in the receiver before framing.
        overruns: u32,
        /// Device time of the message, in us; wraps around. Absent if the drive has no clock.
        device_time_us: Option<u32>,
    }

    /// Outcome of a request that has no answer of its own.
    0x85 CommandResult {
        /// Kind byte of the request.
        request: u8,
        /// Outcome of the request.
        outcome: Outcome,
        /// State after the request.
        state: State,
        /// Further detail, as defined by the outcome; else 0.
        detail: u32,
        /// Device time of the message, in us; wraps around. Absent if the drive has no clock.
        device_time_us: Option<u32>,
    }

    /// Name of a control law.
    0x86 LawDescription {
        /// Index of the law: the value of the parameter `controller`, and the bit in the laws of parameters and signals.
        index: u8,
        /// Name of the law.
        name: LawName,
    }

    /// Name, unit and laws of a signal.
    0x87 SignalDescription {
        /// Index of the signal: the bit in the signals of `Subscribe`.
        index: u8,
        /// Laws that the signal belongs to: bit `n` stands for the law with index `n`. A signal of the drive itself belongs to
        /// all laws.
        laws: u16,
        /// Name, with the unit as its suffix.
        name: SignalName,
        /// Unit as text; empty for a pure number.
        unit: UnitName,
    }

    /// Name of a value of a parameter with choices, or of a value of one of the drive's lists.
    0x88 ChoiceDescription {
        /// Index of the parameter, or number of the list.
        parameter: u8,
        /// The value that has this name.
        choice: u8,
        /// Name of the choice.
        name: ChoiceName,
    }

    /// Rows of the last capture.
    0x89 CaptureRows {
        /// Number of the first row in this message.
        first: u16,
        /// Number of the row of the event.
        event: u16,
        /// Rows one after the other, each with the values of the captured signals in ascending order of their indices.
        values: TelemetryValues,
    }

    /// The torque for one sample.
    0x90 TorqueAnswer {
        /// Sequence of the sample that this message answers.
        sequence: u16,
        /// Torque to hold until the next answer, in N m; zero unless running.
        torque_nm: f32,
        /// State after the step, and flags of this torque.
        status: TorqueStatus,
        /// Time from the arrival of the sample to this answer, in 0.1 us; saturates.
        compute_tenths_us: u16,
    }

    /// Values of the subscribed signals.
    0x91 Telemetry {
        /// Sequence of the sample that these values belong to.
        sequence: u16,
        /// Values of the subscribed signals, in ascending order of their indices. Each has the unit of its signal.
        values: TelemetryValues,
    }

    /// The latched fault.
    0x92 FaultReport {
        /// Cause.
        code: FaultCode,
        /// Sequence of the last sample taken.
        sequence: u16,
        /// The value that violated the limit, in the unit of the code; 0 for a code without one.
        value: f32,
        /// The violated limit; 0 for a code without one.
        limit: f32,
        /// Further detail, as defined by the code.
        detail: u32,
        /// Device time of the message, in us; wraps around. Absent if the drive has no clock.
        device_time_us: Option<u32>,
    }

    /// A log text of the firmware.
    0x93 Log {
        /// Severity.
        level: LogLevel,
        /// Text, without a line end.
        text: Text<52>,
        /// Device time of the message, in us; wraps around. Absent if the drive has no clock.
        device_time_us: Option<u32>,
    }

    /// Bench mode: what the drive measured and applied in one control period.
    0x95 BenchSample {
        /// Number of the control step since the start, from 0; wraps around.
        sequence: u16,
        /// Motor encoder of the drive, in counts; wraps around.
        motor_counts: EncoderCounts,
        /// Load encoder of the drive, in counts; wraps around.
        load_counts: EncoderCounts,
        /// Number of the reference of this step.
        reference_number: u16,
        /// Torque from this step to the next one, in N m; zero unless running.
        torque_nm: f32,
        /// State after the step, and flags of this torque.
        status: TorqueStatus,
        /// Time from the start of the step to this message, in 0.1 us; saturates.
        compute_tenths_us: u16,
        /// Time from the due time of the step to its start, in 0.1 us; saturates.
        lateness_tenths_us: u16,
    }
}

impl DriveMessage {
    /// Device time of the message, in us, if its kind has the field.
    pub fn device_time_us_mut(&mut self) -> Option<&mut Option<u32>> {
        match self {
            Self::Identity(it) => Some(&mut it.device_time_us),
            Self::ParameterReport(it) => Some(&mut it.device_time_us),
            Self::LineReport(it) => Some(&mut it.device_time_us),
            Self::CommandResult(it) => Some(&mut it.device_time_us),
            Self::FaultReport(it) => Some(&mut it.device_time_us),
            Self::Log(it) => Some(&mut it.device_time_us),
            Self::ParameterDescription(_)
            | Self::LawDescription(_)
            | Self::SignalDescription(_)
            | Self::ChoiceDescription(_)
            | Self::CaptureRows(_)
            | Self::TorqueAnswer(_)
            | Self::Telemetry(_)
            | Self::BenchSample(_) => None,
        }
    }
}
