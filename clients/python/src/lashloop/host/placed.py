"""What a drive said, and the control period it speaks of.

Sequences wrap, control periods are counted on. So a message is placed when it comes: what is kept of it stays right
however long the run goes on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from lashloop.sequence import nearest_step
from lashloop.enums import FaultCode

if TYPE_CHECKING:
    from lashloop.messages import FaultReport, Telemetry, TorqueAnswer

M = TypeVar("M", "Telemetry", "TorqueAnswer")

_UNITS = {
    FaultCode.WATCHDOG: "s",
    FaultCode.TORQUE_NOT_FINITE: "N m",
    FaultCode.REFERENCE_NOT_FINITE: "rad",
    FaultCode.MOTOR_ENCODER_JUMP: "rad/s",
    FaultCode.LOAD_ENCODER_JUMP: "rad/s",
}


@dataclass(frozen=True, slots=True)
class Placed(Generic[M]):
    """A message about a sample."""

    step: int
    """The control period of the sample, from 0 at the start."""
    message: M

    @classmethod
    def near(cls, step: int, message: M) -> Placed[M]:
        """Place what came while the sample of `step` was the last one sent.

        A sequence that none of the samples can have had is left as the drive named it.
        """
        meant = nearest_step(message.sequence, step)
        return cls(message.sequence if meant is None else meant, message)


@dataclass(frozen=True, slots=True)
class PlacedFault:
    """A fault, and the sample it names. Its text says all that is known of it."""

    step: int | None
    """The control period of the last sample that the drive had taken, from 0 at the start.

    None if it names no sample of this host's run: it is of an earlier run, or the last words of a firmware.
    """
    message: FaultReport

    @classmethod
    def near(cls, step: int | None, message: FaultReport) -> PlacedFault:
        """Place what came while the sample of `step` was the last one sent; None if this run has sent none."""
        if step is None or message.code.is_last_words:
            return cls(None, message)
        return cls(nearest_step(message.sequence, step), message)

    def __str__(self) -> str:
        """Say which fault, at which sample, which value and which limit."""
        it = self.message
        unit = _UNITS.get(it.code)
        numbers = f": {it.value:g} {unit}, the limit is {it.limit:g} {unit}" if unit else ""
        detail = f", detail {it.detail:#x}" if it.detail else ""
        return f"{it.code}{self._where()}{numbers}{detail}"

    def _where(self) -> str:
        if self.message.code.is_last_words:
            return " (its firmware has stopped: only a reset of the hardware brings it back)"
        return f" (sequence {self.message.sequence})" if self.step is None else f" at sample {self.step}"
