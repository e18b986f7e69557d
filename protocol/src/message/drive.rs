//! The messages of the drive.
//!
//! | kind | message | frame bytes | when |
//! |---|---|---|---|
//! | `0x81` | [`Identity`] | 51 | answers `Hello` |
//! | `0x82` | [`ParameterDescription`] | 62 | answers `DescribeParameter` |
//! | `0x83` | [`ParameterReport`] | 15 | answers `GetParameter` and `SetParameter` |
//! | `0x85` | [`CommandResult`] | 10 | answers every other request, and a sample that the drive rejects |
//! | `0x90` | [`TorqueAnswer`] | 16 | answers `EncoderSample`, before any other message that the sample causes |
//! | `0x91` | [`Telemetry`] | 33 | after every n-th torque while running |
//! | `0x92` | [`FaultReport`] | 22 | when the drive latches a fault, and after an `Identity` while a fault is latched |
//! | `0x93` | [`Log`] | 60 | any time |
//! | `0x94` | [`LineReport`] | 23 | answers `Stop`, before its `CommandResult` |

use crate::enums::{Controllers, FaultCode, LogLevel, Outcome, ParameterValue, State, TorqueStatus, Version};
use crate::text::Text;

messages! {
    /// A message of the drive.
    pub enum DriveMessage: DriveToHost, in every period TorqueAnswer;

    /// Identity of the drive. Same layout in every protocol version.
    0x81 Identity {
        /// Protocol version of the drive.
        protocol_version: u8,
        /// Session of the `Hello` that this message answers.
        session: u32,
        /// Version of the firmware.
        firmware: Version,
        /// First 32 bits of the commit the firmware was built from; 0 if unknown.
        build_id: u32,
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
        /// Control laws offered.
        controllers: Controllers,
        /// Number of parameters.
        parameter_count: u8,
    }

    /// Name, unit, type and range of a parameter.
    0x82 ParameterDescription {
        /// Index of the parameter.
        index: u8,
        /// 1 if the parameter may be set while running, else 0.
        live: u8,
        /// Value after power-up.
        default: ParameterValue,
        /// Smallest value accepted.
        min: ParameterValue,
        /// Largest value accepted.
        max: ParameterValue,
        /// Name, with the unit as its suffix.
        name: Text<28>,
        /// Unit as text; empty for a pure number.
        unit: Text<10>,
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
    }

    /// Outcome of a request that has no answer of its own.
    0x85 CommandResult {
        /// Kind byte of the request.
        request: u8,
        /// Outcome of the request.
        outcome: Outcome,
        /// State after the request.
        state: State,
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

    /// Signals of the control law.
    0x91 Telemetry {
        /// Sequence of the sample that these signals belong to.
        sequence: u16,
        /// Estimate of the dead-zone amplitude used in this step's torque, in rad.
        dead_zone_estimate_rad: f32,
        /// Estimate of the disturbing torque, in N m.
        disturbing_torque_nm: f32,
        /// Error of the load position, in rad.
        load_error_rad: f32,
        /// Error of the motor position relative to the output of the outer loop, in rad.
        motor_error_rad: f32,
        /// Error of the elastic torque, in N m.
        elastic_error_nm: f32,
        /// Torque of the control law before the torque limit, in N m.
        requested_torque_nm: f32,
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
    }

    /// A log text of the firmware.
    0x93 Log {
        /// Severity.
        level: LogLevel,
        /// Text, without a line end.
        text: Text<52>,
    }

    /// Receive statistics of the drive since the start of the run.
    0x94 LineReport {
        /// Messages received.
        messages: u32,
        /// Damaged frames.
        damaged: u32,
        /// Whole frames that are no message of this protocol version.
        refused: u32,
        /// Bytes lost in the receiver before framing.
        overruns: u32,
    }
}
