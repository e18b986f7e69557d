"""The lists of values on the wire, section 5 of `docs/protocol.md`.

Lists are closed: a byte that is in none of them makes its message refused.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from enum import IntEnum, IntFlag

_SINGLE = struct.Struct("<f")
_SPELT_OUT = 1e9


def single(number: float) -> float:
    """Round to the nearest binary32; what is too large for one becomes an infinity."""
    try:
        rounded: float = _SINGLE.unpack(_SINGLE.pack(number))[0]
    except OverflowError:
        return math.copysign(math.inf, number)
    return rounded


def spell(number: float) -> str:
    """Spell a number in single precision with the fewest digits that give it again."""
    if number.is_integer() and abs(number) < _SPELT_OUT:
        return str(int(number))
    digits = (f"{number:.{count}g}" for count in range(1, 10))
    return next((text for text in digits if single(float(text)) == number), str(number))


class WireEnum(IntEnum):
    """A list of values, a byte each."""

    @property
    def label(self) -> str:
        """The name as the specification spells it."""
        return "".join(word.capitalize() for word in self.name.split("_"))

    def __str__(self) -> str:
        """Give the name as the specification spells it."""
        return self.label


class State(WireEnum):
    """Where a drive is in its life."""

    BOOT = 1
    IDLE = 2
    ARMED = 3
    RUNNING = 4
    FAULTED = 5


class FaultCode(WireEnum):
    """What put a drive into `Faulted`."""

    WATCHDOG = 1
    EMERGENCY_STOP = 2
    TORQUE_NOT_FINITE = 3
    REFERENCE_NOT_FINITE = 4
    MOTOR_ENCODER_JUMP = 5
    LOAD_ENCODER_JUMP = 6
    PANIC = 7
    PROCESSOR_FAULT = 8

    @property
    def is_last_words(self) -> bool:
        """Whether these are a firmware's last words, section 8: their sequence is 0 and names no sample."""
        return self in (FaultCode.PANIC, FaultCode.PROCESSOR_FAULT)


class Outcome(WireEnum):
    """What became of a request."""

    ACCEPTED = 1
    WRONG_STATE = 2
    WRONG_SESSION = 3
    VERSION_MISMATCH = 4
    UNKNOWN_PARAMETER = 5
    WRONG_TYPE = 6
    OUT_OF_RANGE = 7
    OUT_OF_SEQUENCE = 8
    INCONSISTENT = 9


class LogLevel(WireEnum):
    """Weight of a line for people."""

    DEBUG = 1
    INFO = 2
    WARNING = 3
    ERROR = 4


class ParameterType(WireEnum):
    """What the four bytes of a parameter's value are."""

    U32 = 1
    F32 = 2


class ControllerId(WireEnum):
    """Values of the parameter `controller` that have a name."""

    PD = 1
    MERZOUKI = 2
    MERZOUKI_AS_PRINTED = 3
    BACKLASH_INVERSE = 4


class DisturbingTorqueSource(WireEnum):
    """Values of the parameter `disturbing_torque_source`."""

    MODEL = 1
    OBSERVED = 2


class TorqueFlags(IntFlag):
    """What is to be known of a torque."""

    SATURATED = 0x10
    REPEATED = 0x20
    GAP = 0x40


@dataclass(frozen=True, slots=True)
class TorqueStatus:
    """State after a control step, and what is to be known of its torque: one byte, `state | flags`."""

    state: State
    flags: TorqueFlags


class Controllers(IntFlag):
    """Control laws a drive offers: bit n stands for the law n. A drive may offer more than have a name."""

    PD = 0x0002
    MERZOUKI = 0x0004
    MERZOUKI_AS_PRINTED = 0x0008
    BACKLASH_INVERSE = 0x0010

    def offers(self, controller: int) -> bool:
        """Whether the law of this number is offered."""
        return bool(self.value >> controller & 1)


@dataclass(frozen=True, slots=True)
class Version:
    """Version of a firmware."""

    major: int
    minor: int
    patch: int

    def __str__(self) -> str:
        """Give `major.minor.patch`."""
        return f"{self.major}.{self.minor}.{self.patch}"


@dataclass(frozen=True, slots=True)
class ParameterValue:
    """A number with its type on the wire."""

    type: ParameterType
    value: int | float

    @classmethod
    def u32(cls, value: int) -> ParameterValue:
        """Make an unsigned number."""
        return cls(ParameterType.U32, value)

    @classmethod
    def f32(cls, value: float) -> ParameterValue:
        """Make a real number, rounded to single precision: the one that arrives."""
        return cls(ParameterType.F32, single(value))

    def __str__(self) -> str:
        """Give the number with the digits that its type holds."""
        return str(self.value) if self.type is ParameterType.U32 else spell(float(self.value))
