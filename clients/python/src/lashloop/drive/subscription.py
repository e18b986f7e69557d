"""The subscription of a host: which signals the telemetry carries, and how often."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.enums import Outcome
from lashloop.layout import MAX_TELEMETRY_VALUES

if TYPE_CHECKING:
    from lashloop.drive.description import Description
    from lashloop.messages import Subscribe


@dataclass(frozen=True, slots=True)
class Subscription:
    """Signals by index, in ascending order, and the interval in control periods; no telemetry for none, or for 0."""

    signals: tuple[int, ...] = ()
    every: int = 0

    @classmethod
    def of(cls, request: Subscribe) -> Subscription:
        """Convert the bits of the request."""
        return cls(tuple(it for it in range(request.signals.bit_length()) if request.signals >> it & 1), request.every)

    def is_due(self, sequence: int) -> bool:
        """Whether telemetry follows the torque of this sample."""
        return self.every > 0 and bool(self.signals) and sequence % self.every == 0

    def check(self, description: Description) -> Outcome:
        """Check that the drive has the signals, and that their values fit into a frame."""
        if any(it >= len(description.signals) for it in self.signals):
            return Outcome.UNKNOWN_INDEX
        return Outcome.ACCEPTED if len(self.signals) <= MAX_TELEMETRY_VALUES else Outcome.OUT_OF_RANGE

    def foreign_signal(self, description: Description, law: int) -> str | None:
        """Return the first signal that the law does not have; None if it has all."""
        foreign = [it for it in self.signals if not description.has_signal(law, it)]
        return description.signals[foreign[0]].name if foreign else None
