"""The messages of protocol version 1.0, section 4 of `docs/protocol.md`. A field's name ends in its unit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from lashloop.layout import (
    F32,
    I24,
    U8,
    U16,
    U32,
    CapabilitiesField,
    CaptureTriggerField,
    F32s,
    FaultCodeField,
    Layout,
    LogLevelField,
    OptionalU32,
    OutcomeField,
    ParameterFlagsField,
    StateField,
    StatusField,
    Text10,
    Text16,
    Text27,
    Text28,
    Text32,
    Text52,
    Value,
    VersionField,
    ZeroSourceField,
)
from lashloop.limits import MINOR_VERSION, PROTOCOL_VERSION


class Message:
    """A message of either direction."""

    __slots__ = ()
    KIND: ClassVar[int]


class HostMessage(Message):
    """A message of the host."""

    __slots__ = ()


class DriveMessage(Message):
    """A message of the drive."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Hello(HostMessage):
    """Opens a session and requests the identity."""

    KIND: ClassVar[int] = 0x01
    protocol_version: U8
    minor_version: U8
    session: U32

    @classmethod
    def of(cls, session: int) -> Hello:
        """Open this session with the versions of this package."""
        return cls(PROTOCOL_VERSION, MINOR_VERSION, session)


@dataclass(frozen=True, slots=True)
class DescribeParameter(HostMessage):
    """Requests name, unit, type, range, flags and laws of a parameter."""

    KIND: ClassVar[int] = 0x02
    index: U8


@dataclass(frozen=True, slots=True)
class GetParameter(HostMessage):
    """Requests the value in force."""

    KIND: ClassVar[int] = 0x03
    index: U8


@dataclass(frozen=True, slots=True)
class SetParameter(HostMessage):
    """Sets a parameter."""

    KIND: ClassVar[int] = 0x04
    index: U8
    value: Value


@dataclass(frozen=True, slots=True)
class Arm(HostMessage):
    """Builds the controller from the parameters; torque stays zero."""

    KIND: ClassVar[int] = 0x05
    session: U32


@dataclass(frozen=True, slots=True)
class Start(HostMessage):
    """Starts the control law; the next sample carries sequence 0."""

    KIND: ClassVar[int] = 0x06
    session: U32


@dataclass(frozen=True, slots=True)
class Stop(HostMessage):
    """Ends a run."""

    KIND: ClassVar[int] = 0x07


@dataclass(frozen=True, slots=True)
class EmergencyStop(HostMessage):
    """Torque zero and a latched fault."""

    KIND: ClassVar[int] = 0x08


@dataclass(frozen=True, slots=True)
class ClearFault(HostMessage):
    """Clears the latched fault."""

    KIND: ClassVar[int] = 0x09


@dataclass(frozen=True, slots=True)
class Reset(HostMessage):
    """Returns the drive to its state after power-up."""

    KIND: ClassVar[int] = 0x0A


@dataclass(frozen=True, slots=True)
class DescribeLaw(HostMessage):
    """Requests the name of a control law."""

    KIND: ClassVar[int] = 0x0B
    index: U8


@dataclass(frozen=True, slots=True)
class DescribeSignal(HostMessage):
    """Requests name, unit and laws of a signal."""

    KIND: ClassVar[int] = 0x0C
    index: U8


@dataclass(frozen=True, slots=True)
class DescribeChoice(HostMessage):
    """Requests the name of a value of a parameter with choices, or of one of the drive's lists (`limits`)."""

    KIND: ClassVar[int] = 0x0D
    parameter: U8
    choice: U8


@dataclass(frozen=True, slots=True)
class Subscribe(HostMessage):
    """Selects the signals of the telemetry, bit n for signal n, and its rate."""

    KIND: ClassVar[int] = 0x0E
    signals: U32
    every: U16


@dataclass(frozen=True, slots=True)
class EnterLoader(HostMessage):
    """Starts the boot loader."""

    KIND: ClassVar[int] = 0x0F
    session: U32


@dataclass(frozen=True, slots=True)
class EncoderSample(HostMessage):
    """Readings of the two encoders at the start of a control period."""

    KIND: ClassVar[int] = 0x10
    sequence: U16
    motor_counts: I24
    load_counts: I24
    reference_rad: F32


@dataclass(frozen=True, slots=True)
class Reference(HostMessage):
    """Reference of bench mode; restarts the watchdog."""

    KIND: ClassVar[int] = 0x11
    number: U16
    reference_rad: F32


@dataclass(frozen=True, slots=True)
class StoreParameters(HostMessage):
    """Makes the values in force the defaults, after power-up and `Reset` too."""

    KIND: ClassVar[int] = 0x20


@dataclass(frozen=True, slots=True)
class RecallParameters(HostMessage):
    """Sets every parameter to its default."""

    KIND: ClassVar[int] = 0x21


@dataclass(frozen=True, slots=True)
class ForgetParameters(HostMessage):
    """Sets every parameter, and its default, to that of the firmware."""

    KIND: ClassVar[int] = 0x22


@dataclass(frozen=True, slots=True)
class SetZero(HostMessage):
    """Makes a position of motor and load the zero of both encoders of bench mode."""

    KIND: ClassVar[int] = 0x23
    source: ZeroSourceField


@dataclass(frozen=True, slots=True)
class Capture(HostMessage):
    """Records signals around an event, bit n for signal n; no signal ends the capture."""

    KIND: ClassVar[int] = 0x24
    signals: U32
    every: U16
    before: U16
    trigger: CaptureTriggerField
    trigger_signal: U8
    level: F32


@dataclass(frozen=True, slots=True)
class ReadCapture(HostMessage):
    """Requests rows of the capture, from this one on."""

    KIND: ClassVar[int] = 0x25
    first: U16


@dataclass(frozen=True, slots=True)
class Identity(DriveMessage):
    """Identity of the drive."""

    KIND: ClassVar[int] = 0x81
    protocol_version: U8
    minor_version: U8
    session: U32
    firmware: VersionField
    build_id: U32
    dirty: U8
    state: StateField
    board: Text16
    period_us: U32
    motor_counts_per_rev: U32
    load_counts_per_rev: U32
    law_count: U8
    signal_count: U8
    parameter_count: U8
    capabilities: CapabilitiesField
    device_time_us: OptionalU32 = None


@dataclass(frozen=True, slots=True)
class ParameterDescription(DriveMessage):
    """Name, unit, type, range, flags and laws of a parameter; bit n of `laws` for law n."""

    KIND: ClassVar[int] = 0x82
    index: U8
    flags: ParameterFlagsField
    laws: U16
    default: Value
    min: Value
    max: Value
    name: Text27
    unit: Text10


@dataclass(frozen=True, slots=True)
class ParameterReport(DriveMessage):
    """Value in force of a parameter after a get or a set."""

    KIND: ClassVar[int] = 0x83
    index: U8
    outcome: OutcomeField
    value: Value
    state: StateField
    detail: U32 = 0
    device_time_us: OptionalU32 = None


@dataclass(frozen=True, slots=True)
class LineReport(DriveMessage):
    """Receive statistics of the drive since the last start."""

    KIND: ClassVar[int] = 0x84
    messages: U32
    damaged: U32
    refused: U32
    overruns: U32
    device_time_us: OptionalU32 = None


@dataclass(frozen=True, slots=True)
class CommandResult(DriveMessage):
    """Outcome of a request that has no answer of its own."""

    KIND: ClassVar[int] = 0x85
    request: U8
    outcome: OutcomeField
    state: StateField
    detail: U32 = 0
    device_time_us: OptionalU32 = None


@dataclass(frozen=True, slots=True)
class LawDescription(DriveMessage):
    """Name of a control law. The index is the value of the parameter `controller`."""

    KIND: ClassVar[int] = 0x86
    index: U8
    name: Text28


@dataclass(frozen=True, slots=True)
class SignalDescription(DriveMessage):
    """Name, unit and laws of a signal; bit n of `laws` for law n."""

    KIND: ClassVar[int] = 0x87
    index: U8
    laws: U16
    name: Text32
    unit: Text10


@dataclass(frozen=True, slots=True)
class ChoiceDescription(DriveMessage):
    """Name of a value of a parameter with choices, or of one of the drive's lists."""

    KIND: ClassVar[int] = 0x88
    parameter: U8
    choice: U8
    name: Text28


@dataclass(frozen=True, slots=True)
class CaptureRows(DriveMessage):
    """Rows of the capture, each with its values in ascending order of the signals' indices."""

    KIND: ClassVar[int] = 0x89
    first: U16
    event: U16
    values: F32s


@dataclass(frozen=True, slots=True)
class TorqueAnswer(DriveMessage):
    """Torque for one sample."""

    KIND: ClassVar[int] = 0x90
    sequence: U16
    torque_nm: F32
    status: StatusField
    compute_tenths_us: U16


@dataclass(frozen=True, slots=True)
class Telemetry(DriveMessage):
    """Values of the subscribed signals, in ascending order of their indices."""

    KIND: ClassVar[int] = 0x91
    sequence: U16
    values: F32s


@dataclass(frozen=True, slots=True)
class FaultReport(DriveMessage):
    """The latched fault."""

    KIND: ClassVar[int] = 0x92
    code: FaultCodeField
    sequence: U16
    value: F32
    limit: F32
    detail: U32
    device_time_us: OptionalU32 = None


@dataclass(frozen=True, slots=True)
class Log(DriveMessage):
    """Log text of the drive."""

    KIND: ClassVar[int] = 0x93
    level: LogLevelField
    text: Text52
    device_time_us: OptionalU32 = None


@dataclass(frozen=True, slots=True)
class BenchSample(DriveMessage):
    """Counts, torque and times of one control step of bench mode."""

    KIND: ClassVar[int] = 0x95
    sequence: U16
    motor_counts: I24
    load_counts: I24
    reference_number: U16
    torque_nm: F32
    status: StatusField
    compute_tenths_us: U16
    lateness_tenths_us: U16


HOST_MESSAGES: tuple[type[HostMessage], ...] = (
    Hello,
    DescribeParameter,
    GetParameter,
    SetParameter,
    Arm,
    Start,
    Stop,
    EmergencyStop,
    ClearFault,
    Reset,
    DescribeLaw,
    DescribeSignal,
    DescribeChoice,
    Subscribe,
    EnterLoader,
    EncoderSample,
    Reference,
    StoreParameters,
    RecallParameters,
    ForgetParameters,
    SetZero,
    Capture,
    ReadCapture,
)
DRIVE_MESSAGES: tuple[type[DriveMessage], ...] = (
    Identity,
    ParameterDescription,
    ParameterReport,
    LineReport,
    CommandResult,
    LawDescription,
    SignalDescription,
    ChoiceDescription,
    CaptureRows,
    TorqueAnswer,
    Telemetry,
    FaultReport,
    Log,
    BenchSample,
)
LAYOUTS: dict[type[Message], Layout] = {it: Layout(it) for it in (*HOST_MESSAGES, *DRIVE_MESSAGES)}
