"""The requests for what a drive describes of itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from lashloop.enums import ParameterFlags, ParameterType
from lashloop.host.description import Parameter, Signal
from lashloop.host.errors import CountError, DescriptionError
from lashloop.host.names import rejection
from lashloop.limits import MAX_LAWS, MAX_PARAMETERS, MAX_SIGNALS
from lashloop.messages import (
    ChoiceDescription,
    CommandResult,
    DescribeChoice,
    DescribeLaw,
    DescribeParameter,
    DescribeSignal,
    DriveMessage,
    HostMessage,
    LawDescription,
    ParameterDescription,
    ParameterReport,
    SignalDescription,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from lashloop.host.line import DriveLine
    from lashloop.messages import Identity

_LARGEST_CHOICE = 255
D = TypeVar("D", LawDescription, ParameterDescription, ChoiceDescription, SignalDescription)


@dataclass(frozen=True, slots=True)
class DriveDescription:
    """Laws, parameters and signals of a drive, in the order of their indices."""

    laws: tuple[str, ...]
    parameters: Mapping[str, Parameter]
    signals: Mapping[str, Signal]


def check_counts(identity: Identity) -> None:
    """Raise `CountError` for a number that a drive can't have."""
    for things, count, fewest, most in (
        ("laws", identity.law_count, 1, MAX_LAWS),
        ("signals", identity.signal_count, 0, MAX_SIGNALS),
        ("parameters", identity.parameter_count, 0, MAX_PARAMETERS),
    ):
        if not fewest <= count <= most:
            raise CountError(things, count, fewest, most)


def describe(line: DriveLine, identity: Identity) -> DriveDescription:
    """Request everything that the drive describes; `RejectedError` if it lacks an index that its identity counts."""
    laws = tuple(_law(line, index).name for index in range(identity.law_count))
    parameters = [_parameter(line, index, laws) for index in range(identity.parameter_count)]
    signals = [Signal.of(_signal(line, index), laws) for index in range(identity.signal_count)]
    return DriveDescription(laws, {it.name: it for it in parameters}, {it.name: it for it in signals})


def _law(line: DriveLine, index: int) -> LawDescription:
    return _request(line, DescribeLaw(index), LawDescription, lambda it: it.index == index)


def _signal(line: DriveLine, index: int) -> SignalDescription:
    return _request(line, DescribeSignal(index), SignalDescription, lambda it: it.index == index)


def _parameter(line: DriveLine, index: int, laws: tuple[str, ...]) -> Parameter:
    it = _request(line, DescribeParameter(index), ParameterDescription, lambda it: it.index == index)
    if ParameterFlags.CHOICES not in it.flags:
        return Parameter.of(it, laws, [])
    if it.max.type is not ParameterType.U32 or it.max.value > _LARGEST_CHOICE:
        raise DescriptionError(it.name, str(it.max))
    values = range(int(it.min.value), int(it.max.value) + 1)
    return Parameter.of(it, laws, [_choice(line, index, value).name for value in values])


def _choice(line: DriveLine, parameter: int, value: int) -> ChoiceDescription:
    def is_answer(it: ChoiceDescription) -> bool:
        return (it.parameter, it.choice) == (parameter, value)

    return _request(line, DescribeChoice(parameter, value), ChoiceDescription, is_answer)


def _request(line: DriveLine, request: HostMessage, kind: type[D], is_answer: Callable[[D], bool]) -> D:
    def wanted(message: DriveMessage) -> D | None:
        if isinstance(message, kind):
            return message if is_answer(message) else None
        if isinstance(message, CommandResult) and message.request == request.KIND:
            raise rejection(line, request, message)
        # A drive answers `DescribeParameter` with an unknown index by this report.
        if isinstance(request, DescribeParameter) and isinstance(message, ParameterReport):
            raise rejection(line, request, message)
        return None

    return line.request(request, wanted)
