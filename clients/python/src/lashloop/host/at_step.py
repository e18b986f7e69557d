"""A message of a drive with its control period.

Sequences wrap around, control periods do not. A message gets its control period on arrival, so that the period stays
correct for any length of the run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from lashloop.enums import FaultCode
from lashloop.sequence import nearest_step

if TYPE_CHECKING:
    from lashloop.messages import FaultReport, Telemetry, TorqueAnswer

M = TypeVar("M", bound="TorqueAnswer")

_UNITS = {
    FaultCode.WATCHDOG: "s",
    FaultCode.TORQUE_NOT_FINITE: "N m",
    FaultCode.REFERENCE_NOT_FINITE: "rad",
    FaultCode.MOTOR_ENCODER_JUMP: "rad/s",
    FaultCode.LOAD_ENCODER_JUMP: "rad/s",
    FaultCode.MOTOR_ENCODER_LOST: "rad",
    FaultCode.LOAD_ENCODER_LOST: "rad",
    FaultCode.TICK_OVERRUN: "s",
    FaultCode.MOTOR_AGAINST_TORQUE: "rad",
    FaultCode.MOTOR_TRAVEL: "rad",
    FaultCode.LOAD_TRAVEL: "rad",
    FaultCode.STALL: "s",
    FaultCode.TORQUE_MISSING: "s",
}


@dataclass(frozen=True, slots=True)
class AtStep(Generic[M]):
    """A message with the control period of its sample."""

    step: int
    """Control period of the sample, from 0 at the start."""
    message: M

    @classmethod
    def near(cls, step: int, message: M) -> AtStep[M]:
        """Assign the control period to a message received while the sample of `step` was the last one sent."""
        return cls(_step_of(message.sequence, step), message)


@dataclass(frozen=True, slots=True)
class TelemetryAtStep:
    """Telemetry with the control period of its sample and the names of its signals."""

    step: int
    """Control period of the sample, from 0 at the start."""
    message: Telemetry
    signals: tuple[str, ...]
    """Names of the values, in their order; empty if the subscription is that of an earlier host."""

    @classmethod
    def near(cls, step: int, message: Telemetry, subscription: tuple[str, ...]) -> TelemetryAtStep:
        """Assign the control period to telemetry received while the sample of `step` was the last one sent."""
        names = subscription if len(subscription) == len(message.values) else ()
        return cls(_step_of(message.sequence, step), message, names)

    @property
    def values(self) -> dict[str, float]:
        """The values by name of signal."""
        return dict(zip(self.signals, self.message.values, strict=False))

    def __getitem__(self, signal: str) -> float:
        """Return the value of a signal; `KeyError` if the subscription does not have it."""
        return self.values[signal]


@dataclass(frozen=True, slots=True)
class FaultAtStep:
    """A fault with the control period of its sample. Its text names value, unit and limit."""

    step: int | None
    """Control period of the last sample that the drive had taken, from 0 at the start.

    None if the fault belongs to an earlier run or to a firmware that has stopped.
    """
    message: FaultReport
    name: str | None = None
    """The drive's name of a code that this host has no name for; empty if it has none, None if it wasn't asked."""

    @classmethod
    def near(cls, step: int | None, message: FaultReport) -> FaultAtStep:
        """Assign the control period to a fault received while the sample of `step` was the last one sent."""
        if step is None or message.code.is_firmware_stop:
            return cls(None, message)
        return cls(nearest_step(message.sequence, step), message)

    def __str__(self) -> str:
        """Name the fault, its sample, value and limit."""
        it = self.message
        detail = f", detail {it.detail:#x}" if it.detail else ""
        return f"{self.name or it.code}{self._where()}{self._numbers()}{detail}"

    def _numbers(self) -> str:
        it = self.message
        # The unit of a code without a name is unknown.
        unit = f" {_UNITS[it.code]}" if it.code in _UNITS else "" if not it.code.is_named else None
        if unit is None or (it.value, it.limit) == (0.0, 0.0):
            return ""
        return f": {it.value:g}{unit}, the limit is {it.limit:g}{unit}"

    def _where(self) -> str:
        if self.message.code.is_firmware_stop:
            return " (the firmware has stopped: reset the hardware)"
        return f" (sequence {self.message.sequence})" if self.step is None else f" at sample {self.step}"


def _step_of(sequence: int, step: int) -> int:
    """Return the control period nearest to `step`. A sequence without a matching sample is kept as received."""
    nearest = nearest_step(sequence, step)
    return sequence if nearest is None else nearest
