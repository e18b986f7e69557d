"""What a drive describes of itself: laws, parameters with their choices, signals. Constant from power-up.

The tables are the union over the drive and its laws, by name. Laws may share a parameter or a signal if their
declarations of it are equal; a shared parameter is live only if every law that has it takes it live.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Generic, TypeVar

from lashloop.declarations import ParameterSpec, SignalSpec, choice, signal
from lashloop.drive.parameters import DRIVE_PARAMETERS
from lashloop.enums import FaultCode, Outcome, State, TorqueFlags
from lashloop.frames import encode
from lashloop.limits import (
    FAULT_NAMES,
    FLAG_NAMES,
    KIND_NAMES,
    MAX_LAWS,
    MAX_PARAMETERS,
    MAX_SIGNALS,
    OUTCOME_NAMES,
    STATE_NAMES,
)
from lashloop.messages import (
    DRIVE_MESSAGES,
    HOST_MESSAGES,
    ChoiceDescription,
    LawDescription,
    ParameterDescription,
    SignalDescription,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from lashloop.control import ControlLaw
    from lashloop.messages import DriveMessage

_LISTS: Mapping[int, Mapping[int, str]] = {
    FAULT_NAMES: {it.value: it.label for it in FaultCode},
    OUTCOME_NAMES: {it.value: it.label for it in Outcome},
    STATE_NAMES: {it.value: it.label for it in State},
    FLAG_NAMES: {it.value: str(it.name) for it in TorqueFlags},
    KIND_NAMES: {it.KIND: it.__name__ for it in (*HOST_MESSAGES, *DRIVE_MESSAGES)},
}
"""Names of the values of the drive's lists, so that an older host can name those that it lacks."""

REQUESTED_TORQUE = "requested_torque_nm"
DRIVE_SIGNALS = (signal(REQUESTED_TORQUE, "N m"),)
"""Signals of every drive: the torque before the limit."""

Spec = TypeVar("Spec", bound=ParameterSpec | SignalSpec)


class _Table(Generic[Spec]):
    """Parameters or signals in the order of their indices, with the laws that have them."""

    def __init__(self, of_drive: Sequence[Spec], of_laws: Sequence[Sequence[Spec]], most: int) -> None:
        specs: dict[str, Spec] = {}
        laws: dict[str, int] = {}
        every_law = (1 << len(of_laws)) - 1
        masks = [every_law, *(1 << law for law in range(len(of_laws)))]
        groups: list[Sequence[Spec]] = [of_drive, *of_laws]
        for mask, group in zip(masks, groups, strict=True):
            for spec in group:
                if specs.setdefault(spec.name, spec) != spec:
                    raise ValueError(f"two declarations of {spec.name} differ: {specs[spec.name]} and {spec}")
                laws[spec.name] = laws.get(spec.name, 0) | mask
        if len(specs) > most:
            raise ValueError(f"{len(specs)} entries, from {next(iter(specs))} on: a drive has at most {most}")
        self.specs = tuple(specs.values())
        self.laws = tuple(laws.values())


class Description:
    """The tables of a drive with these laws. The index of a law is its place."""

    def __init__(self, laws: Sequence[ControlLaw]) -> None:
        """Collect the tables; `ValueError` for a name that repeats or is too long, or for too many entries."""
        names = [law.name for law in laws]
        if not 1 <= len(laws) <= MAX_LAWS or len(set(names)) != len(names):
            raise ValueError(f"the laws {', '.join(names) or 'none'}: a drive has 1 to {MAX_LAWS}, of different names")
        self.laws = tuple(laws)
        controller = choice("controller", names, names[0])
        self._parameters = _Table((controller, *DRIVE_PARAMETERS), _jointly_live(laws), MAX_PARAMETERS)
        self._signals = _Table(DRIVE_SIGNALS, [it.signals for it in laws], MAX_SIGNALS)
        self.parameters = self._parameters.specs
        self.signals = self._signals.specs
        for message in self._messages():
            # A name that does not fit its field is an error of the laws, not of a request.
            encode(message)

    def has_signal(self, law: int, signal: int) -> bool:
        """Whether the signal belongs to the law."""
        return bool(self._signals.laws[signal] >> law & 1)

    def law(self, index: int) -> LawDescription | None:
        """Return the description of a law; None for an unknown index."""
        return LawDescription(index, self.laws[index].name) if index < len(self.laws) else None

    def parameter(self, index: int) -> ParameterDescription | None:
        """Return the description of a parameter; None for an unknown index."""
        if index >= len(self.parameters):
            return None
        it, laws = self.parameters[index], self._parameters.laws[index]
        return ParameterDescription(index, it.flags, laws, it.default, it.min, it.max, it.name, it.unit)

    def choice(self, parameter: int, value: int) -> ChoiceDescription | None:
        """Return the name of a value; None for an unknown parameter, one without choices, or an unknown value.

        Some numbers that no parameter has stand for a list of the drive.
        """
        if parameter in _LISTS:
            name = _LISTS[parameter].get(value)
            return None if name is None else ChoiceDescription(parameter, value, name)
        choices = self.parameters[parameter].choices if parameter < len(self.parameters) else ()
        return ChoiceDescription(parameter, value, choices[value]) if value < len(choices) else None

    def signal(self, index: int) -> SignalDescription | None:
        """Return the description of a signal; None for an unknown index."""
        if index >= len(self.signals):
            return None
        it = self.signals[index]
        return SignalDescription(index, self._signals.laws[index], it.name, it.unit)

    def _messages(self) -> Iterator[DriveMessage]:
        descriptions: list[DriveMessage | None] = [
            *(self.law(index) for index in range(len(self.laws))),
            *(self.parameter(index) for index in range(len(self.parameters))),
            *(self.signal(index) for index in range(len(self.signals))),
            *(self.choice(at, value) for at, it in enumerate(self.parameters) for value in range(len(it.choices))),
        ]
        return (it for it in descriptions if it is not None)


def _jointly_live(laws: Sequence[ControlLaw]) -> list[list[ParameterSpec]]:
    """Return the parameters of each law, live only if every law that has them takes them live."""
    fixed = {spec.name for law in laws for spec in law.parameters if not spec.live}
    return [[replace(spec, live=spec.live and spec.name not in fixed) for spec in law.parameters] for law in laws]
