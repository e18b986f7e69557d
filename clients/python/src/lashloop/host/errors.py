"""What can go wrong in a conversation, beside a line that is gone (`lashloop.lines.LineError`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lashloop.counts import LARGEST
from lashloop.errors import LashloopError
from lashloop.messages import PROTOCOL_VERSION

if TYPE_CHECKING:
    from lashloop.host.placed import PlacedFault
    from lashloop.enums import Outcome, ParameterValue, State


class HostError(LashloopError):
    """Base of the errors of a conversation."""


class SilenceError(HostError):
    """The drive did not answer in time."""

    def __init__(self, waiting_for: str, limit_s: float, last_seen: str) -> None:
        """Say what it should have answered, how long it was waited for, and how far the conversation had got."""
        super().__init__(f"the drive was silent for {limit_s:g} s after {waiting_for} ({last_seen})")
        self.waiting_for, self.limit_s = waiting_for, limit_s


class GapTooLongError(HostError):
    """So many samples had no answer, in time or late, that no drive would take the next one. It has not been sent."""

    def __init__(self, answered: int, longest: int) -> None:
        """Name the sample answered last, in time or late, and the longest gap in control periods."""
        super().__init__(
            f"the drive answered sample {answered} last, and no drive takes one that is more than {longest} control "
            "periods later: the run is over, start the drive anew"
        )
        self.answered, self.longest = answered, longest


class VersionError(HostError):
    """The drive speaks another version of the protocol."""

    def __init__(self, drive: int) -> None:
        """Name both versions."""
        super().__init__(
            f"the drive speaks protocol version {drive}, this host speaks version {PROTOCOL_VERSION}: "
            "use a firmware and a host of the same version"
        )
        self.drive, self.host = drive, PROTOCOL_VERSION


class RefusedError(HostError):
    """The drive refused a request."""

    def __init__(self, request: str, outcome: Outcome, state: State, said: list[str]) -> None:
        """Say what was asked, why it was refused, in which state, and what the drive said about it."""
        words = f', saying "{"; ".join(said)}"' if said else ""
        super().__init__(f"the drive refused {request} in state {state}: {outcome}{words}")
        self.request, self.outcome, self.state, self.said = request, outcome, state, said


class DriveFaultError(HostError):
    """The drive has latched a fault; the run is over."""

    def __init__(self, fault: PlacedFault) -> None:
        """Say which fault, at which sample, which value and which limit."""
        super().__init__(f"the drive latched {fault}")
        self.fault = fault


class StartTooFarError(HostError, ValueError):
    """The first sample of a run does not say where an encoder stands. Nothing has been sent."""

    def __init__(self, side: str, counts: int) -> None:
        """Name the encoder, and how far a drive would know it to have turned."""
        super().__init__(
            f"{side}_counts = {counts}: a drive that starts knows of {-LARGEST - 1} to {LARGEST}; "
            "take a coarser encoder, or start nearer to 0"
        )
        self.side, self.counts = side, counts


class UnknownParameterError(HostError, KeyError):
    """The drive has no parameter of this name."""

    def __init__(self, name: str, nearest: list[str]) -> None:
        """Name it, and the names most like it."""
        hint = f"; did you mean {' or '.join(nearest)}?" if nearest else ""
        self._sentence = f"the drive has no parameter {name}{hint}"
        super().__init__(self._sentence)
        self.name, self.nearest = name, nearest

    def __str__(self) -> str:
        """Give the sentence; a `KeyError` would quote it."""
        return self._sentence


class ParameterRangeError(HostError, ValueError):
    """A value that the drive says it does not take. Nothing has been sent."""

    def __init__(self, name: str, value: float, allowed: str) -> None:
        """Name the parameter, the value and what is allowed."""
        super().__init__(f"{name} = {value!r}: the drive takes {allowed}")
        self.name, self.value, self.allowed = name, value, allowed


class ParameterRefusedError(HostError):
    """The drive refused a value, or reads back another one."""

    def __init__(self, name: str, wanted: ParameterValue, outcome: Outcome, in_force: ParameterValue) -> None:
        """Name the parameter and the value, and say what the drive answered."""
        super().__init__(f"{name} = {wanted}: the drive answered {outcome} and has {in_force} in force")
        self.name, self.wanted, self.outcome, self.in_force = name, wanted, outcome, in_force
