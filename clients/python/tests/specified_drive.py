"""The drive of the specification's example, made from the tables of its annexes: the Lashloop drive, the law `pd`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from lashloop.control import ControlLaw, ParameterSpec, SignalSpec, choice, f32, signal, u32
from lashloop.control.cascade import PD
from lashloop.drive import Drive
from lashloop.enums import Capabilities
from lashloop.limits import MAX_PARAMETERS
from lashloop.messages import (
    ChoiceDescription,
    DescribeChoice,
    DescribeParameter,
    DescribeSignal,
    Identity,
    ParameterDescription,
    ParameterReport,
    SetParameter,
    SignalDescription,
    Subscribe,
    Telemetry,
)
from specified_pd import SpecifiedPd
from support import table

if TYPE_CHECKING:
    from collections.abc import Callable

    from lashloop.messages import DriveMessage, HostMessage

LAWS = [row[1] for row in table("### Its laws")]
PARAMETERS = table("### Its parameters")
SIGNALS = table("### Its signals")
CHOICES = table("### Its choices")


def parameter(row: list[str]) -> ParameterSpec:
    """The declaration in a row of the table of parameters."""
    _, name, unit, kind, default, low, high, _, live = row[:9]
    choices = [it[2] for it in CHOICES if it[0] == name]
    if choices:
        assert (low, high, unit) == ("0", str(len(choices) - 1), "")
        return choice(name, choices, choices[int(default)], live=live == "yes")
    if kind == "U32":
        return u32(name, unit, int(default), int(low), int(high), live=live == "yes")
    return f32(name, unit, float(default), float(low), float(high), live=live == "yes")


def signal_spec(row: list[str]) -> SignalSpec:
    """The declaration in a row of the table of signals."""
    return signal(row[1], row[2])


def has(law: str, laws: str) -> bool:
    """Whether the cell with the laws of a row names the law."""
    return laws == "all" or law in laws.split(", ")


def specified_drive(clock_ns: Callable[[], int]) -> Drive:
    """A drive with laws, parameters and signals of the specification; every law computes as the profile `pd` does."""
    own_parameters, own_signals = {spec.name for spec in Drive([PD]).parameters.specs}, set(Drive([PD]).signals)
    own_parameters -= {spec.name for spec in PD.parameters}
    own_signals -= {spec.name for spec in PD.signals}
    laws = [
        ControlLaw(
            name=name,
            parameters=tuple(parameter(it) for it in PARAMETERS if has(name, it[7]) and it[1] not in own_parameters),
            signals=tuple(signal_spec(it) for it in SIGNALS if has(name, it[3]) and it[1] not in own_signals),
            build=SpecifiedPd,
        )
        for name in LAWS
    ]
    return Drive(laws, board="stm32f405", build_id=12_648_430, is_dirty=False, clock_ns=clock_ns)


class Translation:
    """Indices of the specification to those of our drive, by name, and back: the order is up to a drive."""

    def __init__(self, drive: Drive) -> None:
        """Read the tables of both, which have equal names."""
        self._parameters = _indices(PARAMETERS, [spec.name for spec in drive.parameters.specs])
        self._signals = _indices(SIGNALS, drive.signals)
        self._subscribed: list[int] = []
        """Indices of the specification in the order of our telemetry."""

    def request(self, message: HostMessage) -> HostMessage:
        """Translate a request of the example for our drive."""
        match message:
            case SetParameter() | DescribeParameter():
                return replace(message, index=self._parameters[message.index])
            case DescribeChoice():
                # Larger numbers than any index stand for lists of the drive.
                return replace(message, parameter=self._parameters.get(message.parameter, message.parameter))
            case DescribeSignal():
                return replace(message, index=self._signals[message.index])
            case Subscribe():
                theirs = [it for it in self._signals if message.signals >> it & 1]
                self._subscribed = sorted(theirs, key=lambda it: self._signals[it])
                return replace(message, signals=sum(1 << self._signals[it] for it in theirs))
            case _:
                return message

    def answer(self, message: DriveMessage) -> DriveMessage:
        """Translate an answer of our drive for the example."""
        match message:
            case Identity():
                # The drive of the example captures, too.
                return replace(message, capabilities=message.capabilities | Capabilities.CAPTURE)
            case ParameterReport() | ParameterDescription():
                return replace(message, index=_key(self._parameters, message.index))
            case ChoiceDescription() if message.parameter <= MAX_PARAMETERS:
                return replace(message, parameter=_key(self._parameters, message.parameter))
            case SignalDescription():
                return replace(message, index=_key(self._signals, message.index))
            case Telemetry():
                values = sorted(zip(self._subscribed, message.values, strict=True))
                return replace(message, values=tuple(value for _, value in values))
            case _:
                return message


def _indices(rows: list[list[str]], ours: list[str]) -> dict[int, int]:
    assert sorted(row[1] for row in rows) == sorted(ours)
    return {int(row[0]): ours.index(row[1]) for row in rows}


def _key(indices: dict[int, int], ours: int) -> int:
    return next(theirs for theirs, it in indices.items() if it == ours)
