"""The lists of values on the wire, section 5 of `docs/protocol.md`.

Lists are open: a newer peer may send values and flags without a name here. They are kept; 0 is never a value.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from typing_extensions import Self

_SINGLE = struct.Struct("<f")
_MAX_PLAIN_INTEGER = 1e9
_LARGEST_BYTE = 255


def single(number: float) -> float:
    """Round to the nearest binary32; a number out of its range becomes infinite."""
    try:
        rounded: float = _SINGLE.unpack(_SINGLE.pack(number))[0]
    except OverflowError:
        return math.copysign(math.inf, number)
    return rounded


def shortest(number: float) -> str:
    """Format a number of single precision with the fewest digits that read back as it."""
    if number.is_integer() and abs(number) < _MAX_PLAIN_INTEGER:
        return str(int(number))
    digits = (f"{number:.{count}g}" for count in range(1, 10))
    return next((text for text in digits if single(float(text)) == number), str(number))


class WireEnum(IntEnum):
    """An open list of values of one byte: any byte but 0 is a value, `FaultCode(77)` too."""

    @classmethod
    def _missing_(cls, value: object) -> Self | None:
        if not isinstance(value, int) or not 0 < value <= _LARGEST_BYTE:
            return None
        unknown = int.__new__(cls, value)
        unknown._name_, unknown._value_ = f"UNKNOWN_{value}", value
        # Kept as the values with a name are, so that `is` compares these too.
        return cast("Self", cls._value2member_map_.setdefault(value, unknown))

    def __reduce_ex__(self, proto: object) -> tuple[type[Self], tuple[int]]:
        """Copy and pickle by value: some versions of Python do it by name, which not every value has."""
        return type(self), (self.value,)

    @property
    def is_named(self) -> bool:
        """Whether this version of the protocol has a name for the value."""
        return self.name in type(self).__members__

    @property
    def label(self) -> str:
        """Name in the specification, or `unknown 77`."""
        if not self.is_named:
            return f"unknown {self.value}"
        return "".join(word.capitalize() for word in self.name.split("_"))

    def __str__(self) -> str:
        """Return the label."""
        return self.label


class State(WireEnum):
    """State of a drive."""

    BOOT = 1
    IDLE = 2
    ARMED = 3
    RUNNING = 4
    FAULTED = 5


class FaultCode(WireEnum):
    """Cause of a latched fault."""

    WATCHDOG = 1
    EMERGENCY_STOP = 2
    TORQUE_NOT_FINITE = 3
    REFERENCE_NOT_FINITE = 4
    MOTOR_ENCODER_JUMP = 5
    LOAD_ENCODER_JUMP = 6
    PANIC = 7
    PROCESSOR_FAULT = 8
    POWER_STAGE = 9
    MOTOR_ENCODER_LOST = 10
    LOAD_ENCODER_LOST = 11
    TICK_OVERRUN = 12
    MOTOR_AGAINST_TORQUE = 13
    MOTOR_TRAVEL = 14
    LOAD_TRAVEL = 15
    STALL = 16
    OVERLOAD = 17
    TORQUE_MISSING = 18
    LIMIT_SWITCH = 19

    @property
    def is_firmware_stop(self) -> bool:
        """Whether the firmware has stopped, section 8: the sequence is 0 and refers to no sample."""
        return self in (FaultCode.PANIC, FaultCode.PROCESSOR_FAULT)


class Outcome(WireEnum):
    """Outcome of a request."""

    ACCEPTED = 1
    WRONG_STATE = 2
    WRONG_SESSION = 3
    VERSION_MISMATCH = 4
    UNKNOWN_INDEX = 5
    WRONG_TYPE = 6
    OUT_OF_RANGE = 7
    OUT_OF_SEQUENCE = 8
    INCONSISTENT = 9
    POWER_STAGE_FAULT = 10
    ENCODER_IMPLAUSIBLE = 11
    UNKNOWN_REQUEST = 12
    SIGNAL_OF_OTHER_LAW = 13
    STORE_FAILED = 14
    NOT_CAPTURED = 15


class LogLevel(WireEnum):
    """Severity of a log text."""

    DEBUG = 1
    INFO = 2
    WARNING = 3
    ERROR = 4


class ParameterType(WireEnum):
    """Type of a parameter's value."""

    U32 = 1
    F32 = 2


class ZeroSource(WireEnum):
    """Position that becomes the zero of both encoders."""

    PRESENT = 1
    HOME = 2


class CaptureTrigger(WireEnum):
    """Event around which a capture records."""

    NOW = 1
    RISING = 2
    FALLING = 3
    FAULT = 4


class ParameterFlags(IntFlag):
    """Properties of a parameter. A bit without a name is one of a newer drive and is kept."""

    LIVE = 0x01
    CHOICES = 0x02


class Capabilities(IntFlag):
    """What a drive can do beyond what every drive must. A bit without a name is kept."""

    DEVICE_TIME = 0x01
    BENCH_MODE = 0x02
    LOADER = 0x04
    STORE = 0x08
    CAPTURE = 0x10

    def __str__(self) -> str:
        """Name the capabilities in words, and the bits without a name as a number."""
        words = [it.name.lower().replace("_", " ") for it in Capabilities if it in self and it.name is not None]
        rest = self.value & ~sum(it.value for it in Capabilities)
        return ", ".join([*words, *([f"unknown {rest:#04x}"] if rest else [])]) or "none"


class TorqueFlags(IntFlag):
    """Conditions of a torque. A bit without a name is one of a newer drive and is kept."""

    SATURATED = 0x10
    REPEATED = 0x20
    GAP = 0x40


@dataclass(frozen=True, slots=True)
class TorqueStatus:
    """State after a control step, and the flags of its torque: one byte, `state | flags`."""

    state: State
    flags: TorqueFlags


@dataclass(frozen=True, slots=True)
class Version:
    """Version of a firmware."""

    major: int
    minor: int
    patch: int

    def __str__(self) -> str:
        """Return `major.minor.patch`."""
        return f"{self.major}.{self.minor}.{self.patch}"


@dataclass(frozen=True, slots=True)
class ParameterValue:
    """A number with its type on the wire."""

    type: ParameterType
    value: int | float
    """The number. Of a type without a name the four bytes, least significant first, as an unsigned integer."""

    @classmethod
    def u32(cls, value: int) -> ParameterValue:
        """Return an unsigned integer value."""
        return cls(ParameterType.U32, value)

    @classmethod
    def f32(cls, value: float) -> ParameterValue:
        """Return a real value, rounded to single precision as on the wire."""
        return cls(ParameterType.F32, single(value))

    def __str__(self) -> str:
        """Return the number with the digits of its type; of a type without a name its bytes and the type."""
        if self.type is ParameterType.F32:
            return shortest(float(self.value))
        return str(self.value) if self.type.is_named else f"{self.value:#010x} ({self.type})"
