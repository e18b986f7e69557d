"""The subscription of a host: which signals the telemetry carries, and how often."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.drive.answers import ACCEPTED, Result
from lashloop.enums import Outcome
from lashloop.limits import MAX_TELEMETRY_VALUES

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

    def check(self, description: Description) -> Result:
        """Check that the drive has the signals, and that their values fit into a frame."""
        if any(it >= len(description.signals) for it in self.signals):
            return Result(Outcome.UNKNOWN_INDEX)
        return ACCEPTED if len(self.signals) <= MAX_TELEMETRY_VALUES else Result(Outcome.OUT_OF_RANGE)

    def check_law(self, description: Description, law: int) -> Result:
        """Check that the law has the signals; the detail of a refusal is the index of the first one that it lacks."""
        foreign = (it for it in self.signals if not description.has_signal(law, it))
        first = next(foreign, None)
        return ACCEPTED if first is None else Result(Outcome.SIGNAL_OF_OTHER_LAW, first)
