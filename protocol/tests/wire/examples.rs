//! One message of each kind, with values that show the byte order and contain zeros.

use lashloop_protocol::enums::{
    Controllers, FaultCode, LogLevel, Outcome, ParameterValue, State, TorqueFlags, TorqueStatus, Version,
};
use lashloop_protocol::message::{
    Arm, ClearFault, CommandResult, DescribeParameter, EmergencyStop, EncoderSample, FaultReport,
    GetParameter, Hello, Identity, LineReport, Log, ParameterDescription, ParameterReport, Reset,
    SetParameter, Start, Stop, Telemetry, TorqueAnswer,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage, PROTOCOL_VERSION};

/// A session number whose four bytes differ.
const SESSION: u32 = 0x4c41_5348;

pub const SAMPLE: EncoderSample = EncoderSample {
    sequence: 258,
    motor_counts: EncoderCounts::wrapping(98304),
    load_counts: EncoderCounts::wrapping(-2),
    reference_rad: 0.5,
};

pub const TORQUE: TorqueAnswer = TorqueAnswer {
    sequence: 258,
    torque_nm: -20.420_353,
    status: TorqueStatus { state: State::Running, flags: TorqueFlags::SATURATED.union(TorqueFlags::GAP) },
    compute_tenths_us: 57,
};

pub fn from_host() -> Vec<HostMessage> {
    vec![
        Hello { protocol_version: PROTOCOL_VERSION, session: SESSION }.into(),
        DescribeParameter { index: 3 }.into(),
        GetParameter { index: 3 }.into(),
        SetParameter { index: 3, value: ParameterValue::F32(25.0) }.into(),
        Arm { session: SESSION }.into(),
        Start { session: SESSION }.into(),
        Stop {}.into(),
        EmergencyStop {}.into(),
        ClearFault {}.into(),
        Reset {}.into(),
        SAMPLE.into(),
    ]
}

pub fn from_drive() -> Vec<DriveMessage> {
    vec![
        Identity {
            protocol_version: PROTOCOL_VERSION,
            session: SESSION,
            firmware: Version { major: 0, minor: 1, patch: 0 },
            build_id: 0x00c0_ffee,
            state: State::Idle,
            board: Text::new("stm32f405"),
            period_us: 1000,
            motor_counts_per_rev: 131_072,
            load_counts_per_rev: 131_072,
            controllers: Controllers::PD | Controllers::MERZOUKI,
            parameter_count: 27,
        }
        .into(),
        ParameterDescription {
            index: 3,
            live: 0,
            default: ParameterValue::F32(20.0),
            min: ParameterValue::F32(0.0),
            max: ParameterValue::F32(1000.0),
            name: Text::new("torque_limit_nm"),
            unit: Text::new("N m"),
        }
        .into(),
        ParameterReport {
            index: 3,
            outcome: Outcome::OutOfRange,
            value: ParameterValue::U32(20_000),
            state: State::Idle,
        }
        .into(),
        CommandResult { request: 0x06, outcome: Outcome::WrongState, state: State::Boot }.into(),
        TORQUE.into(),
        Telemetry {
            sequence: 258,
            dead_zone_estimate_rad: 0.16,
            disturbing_torque_nm: -0.64,
            load_error_rad: 1.5,
            motor_error_rad: -0.25,
            elastic_error_nm: 0.0,
            requested_torque_nm: -30.0,
        }
        .into(),
        FaultReport {
            code: FaultCode::MotorEncoderJump,
            sequence: 258,
            value: 4000.0,
            limit: 1000.0,
            detail: 0,
        }
        .into(),
        Log { level: LogLevel::Warning, text: Text::new("crystal does not start, running from HSI") }.into(),
        LineReport { messages: 25_003, damaged: 2, refused: 0, overruns: 1 }.into(),
    ]
}
