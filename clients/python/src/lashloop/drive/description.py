"""What a drive describes of itself: laws, parameters with their choices, signals. Constant from power-up.

The tables are the union over the drive and its laws, by name. Laws may share a parameter or a signal if their
declarations of it are equal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from lashloop.declarations import ParameterSpec, SignalSpec, choice, signal
from lashloop.drive.parameters import DRIVE_PARAMETERS
from lashloop.frames import encode
from lashloop.messages import ChoiceDescription, LawDescription, ParameterDescription, SignalDescription

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from lashloop.control import ControlLaw
    from lashloop.messages import DriveMessage

MOST_LAWS = 16
MOST_SIGNALS = 32
MOST_PARAMETERS = 255

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
        if not 1 <= len(laws) <= MOST_LAWS or len(set(names)) != len(names):
            raise ValueError(f"the laws {', '.join(names) or 'none'}: a drive has 1 to {MOST_LAWS}, of different names")
        self.laws = tuple(laws)
        controller = choice("controller", names, names[0])
        self._parameters = _Table((controller, *DRIVE_PARAMETERS), [it.parameters for it in laws], MOST_PARAMETERS)
        self._signals = _Table(DRIVE_SIGNALS, [it.signals for it in laws], MOST_SIGNALS)
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
        """Return the name of a value; None for an unknown parameter, one without choices, or an unknown value."""
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
