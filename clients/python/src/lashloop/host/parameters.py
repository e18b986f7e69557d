"""A parameter as the drive describes it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.host.errors import ParameterRangeError
from lashloop.enums import ParameterType, ParameterValue

if TYPE_CHECKING:
    from lashloop.messages import ParameterDescription


@dataclass(frozen=True, slots=True)
class Parameter:
    """What is known of a parameter; its index is the drive's affair."""

    index: int
    name: str
    unit: str
    default: ParameterValue
    min: ParameterValue
    max: ParameterValue
    live: bool
    """Whether it may be set while running."""

    @classmethod
    def of(cls, it: ParameterDescription) -> Parameter:
        """Take what the drive said."""
        return cls(it.index, it.name, it.unit, it.default, it.min, it.max, live=it.live == 1)

    @property
    def allowed(self) -> str:
        """Range and unit in words."""
        whole = "a whole number, " if self.default.type is ParameterType.U32 else ""
        return f"{whole}{self.min} to {self.max} {self.unit}".rstrip()

    def value(self, number: float) -> ParameterValue:
        """Give a number as this parameter's type; `ParameterRangeError` if it is none of its values."""
        if self.default.type is ParameterType.U32:
            whole = number == number and abs(number) != float("inf") and number == int(number)
            value = ParameterValue.u32(int(number)) if whole else None
        else:
            value = ParameterValue.f32(number)
        # NaN is in no range.
        if value is None or not self.min.value <= value.value <= self.max.value:
            raise ParameterRangeError(self.name, number, self.allowed)
        return value
