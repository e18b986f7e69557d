//! One message of each kind, with values that show the byte order and contain zeros.

use lashloop_protocol::enums::{
    Capabilities, CaptureTrigger, FaultCode, LogLevel, Outcome, ParameterFlags, ParameterValue, State,
    TorqueFlags, TorqueStatus, Version, ZeroSource,
};
use lashloop_protocol::message::{
    Arm, BenchSample, Capture, CaptureRows, ChoiceDescription, ClearFault, CommandResult, DescribeChoice,
    DescribeLaw, DescribeParameter, DescribeSignal, EmergencyStop, EncoderSample, EnterLoader, FaultReport,
    ForgetParameters, GetParameter, Hello, Identity, LawDescription, LineReport, Log, ParameterDescription,
    ParameterReport, ReadCapture, RecallParameters, Reference, Reset, SetParameter, SetZero,
    SignalDescription, Start, Stop, StoreParameters, Subscribe, Telemetry, TorqueAnswer,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::{
    DriveMessage, EncoderCounts, HostMessage, MINOR_VERSION, PROTOCOL_VERSION, TelemetryValues,
};

/// Number of the request in every example whose kind has one.
pub const NUMBER: u8 = 200;

/// Device time in every example that has one.
pub const DEVICE_TIME_US: Option<u32> = Some(0x0102_0304);

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

/// Values of the signals of `Subscribe` in [`from_host`].
pub fn telemetry_values() -> TelemetryValues {
    TelemetryValues::new(&[-30.0, 0.16, -0.64, 0.0, 1.5]).expect("at most 13 values")
}

pub fn from_host() -> Vec<HostMessage> {
    vec![
        Hello::new(SESSION).into(),
        DescribeParameter { index: 3 }.into(),
        GetParameter { index: 3 }.into(),
        SetParameter { index: 3, value: ParameterValue::F32(25.0) }.into(),
        Arm { session: SESSION }.into(),
        Start { session: SESSION }.into(),
        Stop {}.into(),
        EmergencyStop {}.into(),
        ClearFault {}.into(),
        Reset {}.into(),
        DescribeLaw { index: 1 }.into(),
        DescribeSignal { index: 2 }.into(),
        DescribeChoice { parameter: 20, choice: 1 }.into(),
        Subscribe { signals: 0b10_0001_0111, every: 10 }.into(),
        EnterLoader { session: SESSION }.into(),
        SAMPLE.into(),
        Reference { number: 513, reference_rad: -0.25 }.into(),
        StoreParameters {}.into(),
        RecallParameters {}.into(),
        ForgetParameters {}.into(),
        SetZero { source: ZeroSource::Home }.into(),
        Capture {
            signals: 0b1_0110,
            every: 2,
            before: 64,
            trigger: CaptureTrigger::Rising,
            trigger_signal: 2,
            level: 0.125,
        }
        .into(),
        ReadCapture { first: 258 }.into(),
    ]
}

pub fn from_drive() -> Vec<DriveMessage> {
    vec![
        Identity {
            protocol_version: PROTOCOL_VERSION,
            minor_version: MINOR_VERSION,
            session: SESSION,
            firmware: Version { major: 0, minor: 1, patch: 0 },
            build_id: 0x00c0_ffee,
            dirty: 1,
            state: State::Idle,
            board: Text::new("stm32f405"),
            period_us: 1000,
            motor_counts_per_rev: 131_072,
            load_counts_per_rev: 131_072,
            law_count: 2,
            signal_count: 10,
            parameter_count: 27,
            capabilities: Capabilities::DEVICE_TIME.union(Capabilities::BENCH_MODE),
            device_time_us: DEVICE_TIME_US,
        }
        .into(),
        ParameterDescription {
            index: 3,
            flags: ParameterFlags::LIVE,
            laws: 0b11,
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
            detail: 0,
            device_time_us: DEVICE_TIME_US,
        }
        .into(),
        LineReport { messages: 25_003, damaged: 2, refused: 0, overruns: 1, device_time_us: DEVICE_TIME_US }
            .into(),
        CommandResult {
            request: 0x05,
            outcome: Outcome::Inconsistent,
            state: State::Idle,
            detail: 3,
            device_time_us: DEVICE_TIME_US,
        }
        .into(),
        LawDescription { index: 1, name: Text::new("pi-velocity") }.into(),
        SignalDescription {
            index: 2,
            laws: 0b10,
            name: Text::new("dead_zone_estimate_rad"),
            unit: Text::new("rad"),
        }
        .into(),
        ChoiceDescription { parameter: 20, choice: 1, name: Text::new("observed") }.into(),
        CaptureRows { first: 258, event: 64, values: telemetry_values() }.into(),
        TORQUE.into(),
        Telemetry { sequence: 258, values: telemetry_values() }.into(),
        FaultReport {
            code: FaultCode::MotorEncoderJump,
            sequence: 258,
            value: 4000.0,
            limit: 1000.0,
            detail: 0,
            device_time_us: DEVICE_TIME_US,
        }
        .into(),
        Log {
            level: LogLevel::Warning,
            text: Text::new("crystal does not start, running from HSI"),
            device_time_us: DEVICE_TIME_US,
        }
        .into(),
        BenchSample {
            sequence: 258,
            motor_counts: EncoderCounts::wrapping(98304),
            load_counts: EncoderCounts::wrapping(-2),
            reference_number: 513,
            torque_nm: -7.5,
            status: TorqueStatus { state: State::Running, flags: TorqueFlags::SATURATED },
            compute_tenths_us: 123,
            lateness_tenths_us: 31,
        }
        .into(),
    ]
}
