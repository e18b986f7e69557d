"""Names that a drive gives on request: of the cause of a refusal, and of values that this host has no name for."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import TYPE_CHECKING

from lashloop.enums import Outcome
from lashloop.host.errors import RejectedError, SilenceError
from lashloop.limits import FAULT_NAMES, MAX_PARAMETERS, MAX_SIGNALS, OUTCOME_NAMES
from lashloop.link import LinkError
from lashloop.messages import (
    ChoiceDescription,
    CommandResult,
    DescribeChoice,
    DescribeParameter,
    DescribeSignal,
    DriveMessage,
    ParameterDescription,
    ParameterReport,
    SignalDescription,
)

if TYPE_CHECKING:
    from lashloop.host.at_step import FaultAtStep
    from lashloop.host.line import DriveLine
    from lashloop.messages import HostMessage

_CAUSES = {
    Outcome.POWER_STAGE_FAULT: {
        1: "break input",
        2: "fault line",
        3: "no supply",
        4: "overcurrent",
        5: "overtemperature",
        6: "current sensor",
        7: "overvoltage",
    },
    Outcome.ENCODER_IMPLAUSIBLE: {
        1: "the encoders were not read since power-up",
        2: "the motor encoder moved too fast",
        3: "the load encoder moved too fast",
        4: "both channels of the motor encoder changed at once",
        5: "both channels of the load encoder changed at once",
    },
    Outcome.STORE_FAILED: {
        1: "the memory can't be written",
        2: "the memory is full until the next power-up",
    },
    Outcome.NOT_CAPTURED: {
        1: "the event has not come yet",
        2: "the drive still records",
    },
}


def named_fault(line: DriveLine) -> FaultAtStep | None:
    """Return the last fault report; the drive is asked once for a name that this host lacks."""
    fault = line.fault
    if fault is None or fault.message.code.is_named or fault.name is not None:
        return fault
    named = replace(fault, name=_asked(line, DescribeChoice(FAULT_NAMES, fault.message.code)))
    # Another fault may have been reported meanwhile.
    if line.fault is fault:
        line.fault = named
    return named


def outcome_name(line: DriveLine, outcome: Outcome) -> str:
    """Return the drive's name of an outcome that this host has no name for; empty if it has none, or is silent."""
    return "" if outcome.is_named else _asked(line, DescribeChoice(OUTCOME_NAMES, outcome))


def cause(line: DriveLine, outcome: Outcome, detail: int) -> str:
    """Return the cause of a refusal in words; empty for an outcome without one."""
    match outcome:
        case Outcome.INCONSISTENT:
            parameter = _asked(line, DescribeParameter(detail)) if detail < MAX_PARAMETERS else ""
            return f"{parameter or f'parameter {detail}'} does not go with the other parameters"
        case Outcome.SIGNAL_OF_OTHER_LAW:
            signal = _asked(line, DescribeSignal(detail)) if detail < MAX_SIGNALS else ""
            return f"{signal or f'signal {detail}'} isn't a signal of the law in force"
    words = _CAUSES.get(outcome, {}).get(detail, "")
    return words or (f"detail {detail}" if detail else "")


def rejection(line: DriveLine, request: HostMessage, answer: CommandResult | ParameterReport) -> RejectedError:
    """Return the error of a refused request, with names."""
    outcome = answer.outcome
    words = cause(line, outcome, answer.detail)
    return RejectedError(type(request).__name__, outcome, answer.state, words, outcome_name(line, outcome))


def _asked(line: DriveLine, request: DescribeChoice | DescribeParameter | DescribeSignal) -> str:
    """Return the name in the answer; empty if the drive has none, or if it is silent."""

    def wanted(message: DriveMessage) -> str | None:
        if isinstance(message, ChoiceDescription | ParameterDescription | SignalDescription):
            return message.name
        return "" if isinstance(message, CommandResult | ParameterReport) else None

    with contextlib.suppress(SilenceError, LinkError):
        return line.request(request, wanted)
    return ""
