"""A parameter as the drive describes it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.enums import ParameterType, ParameterValue
from lashloop.host.errors import ParameterRangeError

if TYPE_CHECKING:
    from lashloop.messages import ParameterDescription


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

    @classmethod
    def of(cls, it: ParameterDescription) -> Parameter:
        """Convert the description from the wire."""
        return cls(it.index, it.name, it.unit, it.default, it.min, it.max, live=it.live == 1)

    @property
    def allowed(self) -> str:
        """Range and unit as text."""
        whole = "a whole number, " if self.default.type is ParameterType.U32 else ""
        return f"{whole}{self.min} to {self.max} {self.unit}".rstrip()

    def value(self, number: float) -> ParameterValue:
        """Return a number in this parameter's type; `ParameterRangeError` if it is outside the range."""
        if self.default.type is ParameterType.U32:
            whole = number == number and abs(number) != float("inf") and number == int(number)
            value = ParameterValue.u32(int(number)) if whole else None
        else:
            value = ParameterValue.f32(number)
        # NaN is outside every range.
        if value is None or not self.min.value <= value.value <= self.max.value:
            raise ParameterRangeError(self.name, number, self.allowed)
        return value
