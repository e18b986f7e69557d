"""Errors of a host, other than a failed link (`lashloop.link.LinkError`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from lashloop.counts import LARGEST
from lashloop.errors import LashloopError
from lashloop.limits import PROTOCOL_VERSION

if TYPE_CHECKING:
    from lashloop.enums import Outcome, ParameterValue, State
    from lashloop.host.at_step import FaultAtStep


class HostError(LashloopError):
    """Base of the errors of a host."""


class SilenceError(HostError):
    """The drive did not answer in time."""

    def __init__(self, waiting_for: str, limit_s: float, last_seen: str) -> None:
        """Name the request, the timeout and the last messages."""
        super().__init__(f"the drive was silent for {limit_s:g} s after {waiting_for} ({last_seen})")
        self.waiting_for, self.limit_s = waiting_for, limit_s


class GapTooLongError(HostError):
    """The gap since the last sample answered exceeds the limit of a drive. Nothing has been sent."""

    def __init__(self, answered: int, longest: int) -> None:
        """Name the last sample answered, in time or late, and the longest gap in control periods."""
        super().__init__(
            f"the drive answered sample {answered} last, and a drive rejects a sample more than {longest} control "
            "periods later: the run is over, restart the drive"
        )
        self.answered, self.longest = answered, longest


class VersionError(HostError):
    """The drive has another protocol version."""

    def __init__(self, drive: int) -> None:
        """Name both versions."""
        super().__init__(
            f"the drive has protocol version {drive}, this host has version {PROTOCOL_VERSION}: "
            "use a firmware and a host of the same version"
        )
        self.drive, self.host = drive, PROTOCOL_VERSION


class CountError(HostError):
    """The identity has a number of laws, signals or parameters that a drive can't have."""

    def __init__(self, things: str, count: int, fewest: int, most: int) -> None:
        """Name what is counted, the number and the range."""
        super().__init__(f"the drive has {count} {things}, a drive has {fewest} to {most}: correct the drive")
        self.things, self.count, self.fewest, self.most = things, count, fewest, most


class RejectedError(HostError):
    """The drive rejected a request."""

    def __init__(self, request: str, outcome: Outcome, state: State, cause: str = "", name: str = "") -> None:
        """Name the request, the outcome, the state and the cause.

        `name` is the drive's name of an outcome that this host has no name for.
        """
        super().__init__(f"the drive rejected {request} in state {state}: {_refusal(outcome, cause, name)}")
        self.request, self.outcome, self.state, self.cause = request, outcome, state, cause


class DriveFaultError(HostError):
    """The drive has latched a fault; the run is over."""

    def __init__(self, fault: FaultAtStep) -> None:
        """Name the fault, its sample, value and limit."""
        super().__init__(f"the drive latched {fault}")
        self.fault = fault


class StartTooFarError(HostError, ValueError):
    """The position of an encoder at the start exceeds 24 bits. Nothing has been sent."""

    def __init__(self, side: str, counts: int) -> None:
        """Name the encoder and the range."""
        super().__init__(
            f"{side}_counts = {counts}: the first sample of a run allows {-LARGEST - 1} to {LARGEST}; "
            "use a coarser encoder, or start nearer to 0"
        )
        self.side, self.counts = side, counts


class UnknownNameError(HostError, KeyError):
    """The drive describes nothing of this name."""

    THING: ClassVar[str]

    def __init__(self, name: str, nearest: list[str]) -> None:
        """Name the thing and similar names."""
        hint = f"; did you mean {' or '.join(nearest)}?" if nearest else ""
        self._sentence = f"the drive has no {self.THING} {name}{hint}"
        super().__init__(self._sentence)
        self.name, self.nearest = name, nearest

    def __str__(self) -> str:
        """Return the sentence, which `KeyError` would quote."""
        return self._sentence


class UnknownParameterError(UnknownNameError):
    """The drive has no parameter of this name."""

    THING = "parameter"


class UnknownSignalError(UnknownNameError):
    """The drive has no signal of this name."""

    THING = "signal"


class DescriptionError(HostError):
    """The drive describes names for the values of a parameter that can't have them."""

    def __init__(self, name: str, largest: str) -> None:
        """Name the parameter and its largest value."""
        super().__init__(
            f"the drive describes choices for {name}, whose largest value is {largest}: choices are whole numbers "
            "of at most 255; correct the drive"
        )
        self.name, self.largest = name, largest


class ParameterRangeError(HostError, ValueError):
    """A value that is outside the range, or none of the choices, that the drive describes. Nothing has been sent."""

    def __init__(self, name: str, value: float | str, allowed: str) -> None:
        """Name the parameter, the value and the range."""
        super().__init__(f"{name} = {value!r}: the drive accepts {allowed}")
        self.name, self.value, self.allowed = name, value, allowed


class ParameterRejectedError(HostError):
    """The drive rejected a value, or reads back another one."""

    def __init__(
        self,
        name: str,
        wanted: ParameterValue,
        outcome: Outcome,
        in_force: ParameterValue,
        cause: str = "",
        outcome_name: str = "",
    ) -> None:
        """Name the parameter, the value, the outcome with its cause, and the value in force.

        `outcome_name` is the drive's name of an outcome that this host has no name for.
        """
        refusal = _refusal(outcome, cause, outcome_name)
        super().__init__(f"{name} = {wanted}: the drive answered {refusal} and has {in_force} in force")
        self.name, self.wanted, self.outcome, self.in_force, self.cause = name, wanted, outcome, in_force, cause


def _refusal(outcome: Outcome, cause: str, name: str) -> str:
    return f"{name or outcome} ({cause})" if cause else name or str(outcome)
