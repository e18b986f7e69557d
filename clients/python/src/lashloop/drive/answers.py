"""The messages of a drive, built from its data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.enums import FaultCode, LogLevel, State, Version, single
from lashloop.frames import DELIMITER, encode
from lashloop.messages import (
    PROTOCOL_VERSION,
    FaultReport,
    Identity,
    LineReport,
    Log,
    Telemetry,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from lashloop.decoder import Counters

_BOARD_BYTES = 16
_LOG_BYTES = 52
_U32_MAX = 2**32 - 1


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
        )


def telemetry(sequence: int, values: Iterable[float]) -> Telemetry:
    """Return values of signals. A number too large for single precision becomes infinite."""
    return Telemetry(sequence, tuple(map(single, values)))


def line_report(now: Counters, before: Counters, overruns: int) -> LineReport:
    """Return the receive statistics between two readings of the counters."""
    counts = (now.messages - before.messages, now.damaged - before.damaged, now.refused - before.refused, overruns)
    return LineReport(*(min(count, _U32_MAX) for count in counts))


def log(level: LogLevel, text: str) -> Log:
    """Return a log text, truncated to its field."""
    return Log(level, _fitted(text, _LOG_BYTES))


def fault_frame(line_number: int) -> bytes:
    """Return the frame of a drive whose program has failed: a delimiter, and a fault with the source line."""
    return DELIMITER + encode(FaultReport(FaultCode.PANIC, 0, 0.0, 0.0, line_number))


def _fitted(text: str, size: int) -> str:
    """Truncate a text after the last whole character within `size` bytes; zeros, the padding, are dropped."""
    return text.replace("\0", "").encode()[:size].decode(errors="ignore")
