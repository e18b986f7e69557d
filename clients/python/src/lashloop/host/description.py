"""What a drive describes of itself: parameters and signals, as a host uses them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.enums import ParameterFlags, ParameterType, ParameterValue
from lashloop.host.errors import ParameterRangeError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from lashloop.messages import ParameterDescription, SignalDescription


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a drive."""

    index: int
    name: str
    unit: str
    default: ParameterValue
    min: ParameterValue
    max: ParameterValue
    live: bool
    """Whether the parameter may be set while running."""
    laws: tuple[str, ...]
    """Names of the laws that have the parameter; a parameter of the drive itself names all laws."""
    choices: tuple[str, ...] = ()
    """Names of the values from `min` on; empty for a number."""

    @classmethod
    def of(cls, it: ParameterDescription, laws: Sequence[str], choices: Sequence[str]) -> Parameter:
        """Convert the description from the wire, with the names of all laws, and of the choices."""
        live = ParameterFlags.LIVE in it.flags
        return cls(it.index, it.name, it.unit, it.default, it.min, it.max, live, _named(it.laws, laws), tuple(choices))

    @property
    def allowed(self) -> str:
        """Choices, or range and unit, as text."""
        if self.choices:
            return " | ".join(self.choices)
        if not self.default.type.is_named:
            return f"values of a type that this host does not know ({self.default.type})"
        whole = "a whole number, " if self.default.type is ParameterType.U32 else ""
        return f"{whole}{self.min} to {self.max} {self.unit}".rstrip()

    def value(self, wanted: float | str) -> ParameterValue:
        """Return a number or a choice in this parameter's type; `ParameterRangeError` if it is none of them."""
        if isinstance(wanted, str):
            if wanted not in self.choices:
                raise ParameterRangeError(self.name, wanted, self.allowed)
            return ParameterValue.u32(int(self.min.value) + self.choices.index(wanted))
        if not self.default.type.is_named:
            raise ParameterRangeError(self.name, wanted, self.allowed)
        if self.default.type is ParameterType.U32:
            whole = wanted == wanted and abs(wanted) != float("inf") and wanted == int(wanted)
            value = ParameterValue.u32(int(wanted)) if whole else None
        else:
            value = ParameterValue.f32(wanted)
        # NaN is outside every range.
        if value is None or not self.min.value <= value.value <= self.max.value:
            raise ParameterRangeError(self.name, wanted, self.allowed)
        return value

    def text(self, value: float) -> str:
        """Return a value of this parameter as text: the name of a choice, or the number."""
        if self.choices:
            return self.choices[int(value) - int(self.min.value)]
        return str(self.value(value) if self.default.type.is_named else ParameterValue(self.default.type, int(value)))


@dataclass(frozen=True, slots=True)
class Signal:
    """A signal of a drive."""

    index: int
    name: str
    unit: str
    laws: tuple[str, ...]
    """Names of the laws that have the signal; a signal of the drive itself names all laws."""

    @classmethod
    def of(cls, it: SignalDescription, laws: Sequence[str]) -> Signal:
        """Convert the description from the wire, with the names of all laws."""
        return cls(it.index, it.name, it.unit, _named(it.laws, laws))


def _named(mask: int, laws: Sequence[str]) -> tuple[str, ...]:
    return tuple(name for index, name in enumerate(laws) if mask >> index & 1)
