"""What a drive has to say, as messages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.frames import DELIMITER, encode
from lashloop.messages import (
    PROTOCOL_VERSION,
    FaultReport,
    Identity,
    LineReport,
    Log,
    ParameterDescription,
    Telemetry,
)
from lashloop.enums import Controllers, FaultCode, LogLevel, State, Version, single

if TYPE_CHECKING:
    from collections.abc import Mapping

    from lashloop.control import ControlOutput
    from lashloop.decoder import Counters
    from lashloop.drive.parameters import ParameterSpec

_BOARD_BYTES = 16
_LOG_BYTES = 52
_U32_MAX = 2**32 - 1


@dataclass(frozen=True, slots=True)
class Nameplate:
    """Who the drive is, as long as it has power."""

    board: str
    firmware: Version
    build_id: int
    laws: tuple[int, ...]

    def identity(self, session: int, state: State, parameters: Mapping[str, float]) -> Identity:
        """Answer a greeting."""
        return Identity(
            protocol_version=PROTOCOL_VERSION,
            session=session,
            firmware=self.firmware,
            build_id=self.build_id,
            state=state,
            board=_fitted(self.board, _BOARD_BYTES),
            period_us=int(parameters["period_us"]),
            motor_counts_per_rev=int(parameters["motor_counts_per_rev"]),
            load_counts_per_rev=int(parameters["load_counts_per_rev"]),
            controllers=Controllers(sum(1 << number for number in self.laws)),
            parameter_count=len(parameters),
        )


def description(index: int, spec: ParameterSpec) -> ParameterDescription:
    """Say what a parameter is."""
    return ParameterDescription(index, int(spec.live), spec.default, spec.min, spec.max, spec.name, spec.unit)


def telemetry(sequence: int, opinion: ControlOutput) -> Telemetry:
    """Say what the controller thinks. Its numbers may be too large for single precision, which makes them infinite."""
    return Telemetry(
        sequence,
        single(opinion.dead_zone_estimate_rad),
        single(opinion.disturbing_torque_nm),
        single(opinion.load_error_rad),
        single(opinion.motor_error_rad),
        single(opinion.elastic_error_nm),
        single(opinion.torque_nm),
    )


def line_report(now: Counters, then: Counters, overruns: int) -> LineReport:
    """Say what the receiver has seen between two moments."""
    counts = (now.messages - then.messages, now.damaged - then.damaged, now.refused - then.refused, overruns)
    return LineReport(*(min(count, _U32_MAX) for count in counts))


def log(level: LogLevel, text: str) -> Log:
    """Say something to people, as much of it as fits."""
    return Log(level, _fitted(text, _LOG_BYTES))


def fault_frame(line_number: int) -> bytes:
    """What a drive says when its program can't go on: a delimiter and a fault that names the source line."""
    return DELIMITER + encode(FaultReport(FaultCode.PANIC, 0, 0.0, 0.0, line_number))


def _fitted(text: str, size: int) -> str:
    """Cut a text at the last whole character that fits into `size` bytes; zeros, which are padding, are dropped."""
    return text.replace("\0", "").encode()[:size].decode(errors="ignore")
