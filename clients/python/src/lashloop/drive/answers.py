"""The messages of a drive, built from its data."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

from lashloop.enums import Capabilities, FaultCode, Outcome, State, Version, single
from lashloop.limits import MINOR_VERSION, PROTOCOL_VERSION
from lashloop.messages import (
    CommandResult,
    FaultReport,
    Identity,
    LineReport,
    Log,
    ParameterReport,
    Telemetry,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from lashloop.decoder import Counters
    from lashloop.messages import DriveMessage

_BOARD_BYTES = 16
_U32_MAX = 2**32 - 1


class Result(NamedTuple):
    """Outcome of a request, and the cause of a refusal as a number that the outcome defines."""

    outcome: Outcome
    detail: int = 0


ACCEPTED = Result(Outcome.ACCEPTED)


@dataclass(frozen=True, slots=True)
class Nameplate:
    """Constant part of the identity."""

    board: str
    firmware: Version
    build_id: int
    is_dirty: bool
    law_count: int
    signal_count: int

    def identity(self, session: int, state: State, parameters: Mapping[str, float]) -> Identity:
        """Return the answer to a `Hello`."""
        return Identity(
            protocol_version=PROTOCOL_VERSION,
            minor_version=MINOR_VERSION,
            session=session,
            firmware=self.firmware,
            build_id=self.build_id,
            dirty=int(self.is_dirty),
            state=state,
            board=_fitted(self.board, _BOARD_BYTES),
            period_us=int(parameters["period_us"]),
            motor_counts_per_rev=int(parameters["motor_counts_per_rev"]),
            load_counts_per_rev=int(parameters["load_counts_per_rev"]),
            law_count=self.law_count,
            signal_count=self.signal_count,
            parameter_count=len(parameters),
            capabilities=Capabilities.DEVICE_TIME,
        )


def timed(message: DriveMessage, now_ns: int) -> DriveMessage:
    """Return the message with this device time, if its kind has the field."""
    if isinstance(message, Identity | ParameterReport | LineReport | CommandResult | FaultReport | Log):
        return replace(message, device_time_us=now_ns // 1000 & _U32_MAX)
    return message


def telemetry(sequence: int, values: Iterable[float]) -> Telemetry:
    """Return values of signals. A number too large for single precision becomes infinite."""
    return Telemetry(sequence, tuple(map(single, values)))


def line_report(now: Counters, before: Counters, overruns: int) -> LineReport:
    """Return the receive statistics between two readings of the counters. Requests of unknown kinds are messages."""
    messages = now.messages + now.unknown - before.messages - before.unknown
    counts = (messages, now.damaged - before.damaged, now.refused - before.refused, overruns)
    return LineReport(*(min(count, _U32_MAX) for count in counts))


def panic(line_number: int) -> FaultReport:
    """Return the report of a drive whose program has failed in this line of its source."""
    return FaultReport(FaultCode.PANIC, 0, 0.0, 0.0, line_number)


def _fitted(text: str, size: int) -> str:
    """Truncate a text after the last whole character within `size` bytes; zeros, the padding, are dropped."""
    return text.replace("\0", "").encode()[:size].decode(errors="ignore")
