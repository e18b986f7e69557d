"""Declarations of parameters and signals: each once, by name, with unit; parameters also with default and range.

A name ends in its unit by convention: `k_p1_nm_rad`, `load_error_rad`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.enums import Outcome, ParameterFlags, ParameterValue, single

if TYPE_CHECKING:
    from collections.abc import Sequence

MOST_CHOICES = 256
"""A choice is one byte on the wire."""


@dataclass(frozen=True, slots=True)
class ParameterSpec:
    """Declaration of a parameter. Its index on the wire is its position in the table of the drive."""

    name: str
    unit: str
    default: ParameterValue
    min: ParameterValue
    max: ParameterValue
    live: bool = False
    """Whether the parameter may be set while armed or running, with effect from the next sample.

    See `lashloop.control.LiveController`.
    """
    choices: tuple[str, ...] = ()
    """Names of the values 0, 1, ...; empty for a number."""

    @property
    def flags(self) -> ParameterFlags:
        """Properties on the wire."""
        live = ParameterFlags.LIVE if self.live else ParameterFlags(0)
        return live | (ParameterFlags.CHOICES if self.choices else ParameterFlags(0))

    def check(self, value: ParameterValue) -> Outcome:
        """Check type and range of a value."""
        if value.type is not self.default.type:
            return Outcome.WRONG_TYPE
        # NaN is outside every range.
        in_range = self.min.value <= value.value <= self.max.value
        return Outcome.ACCEPTED if in_range else Outcome.OUT_OF_RANGE


@dataclass(frozen=True, slots=True)
class SignalSpec:
    """Declaration of a signal. Its index on the wire is its position in the table of the drive."""

    name: str
    unit: str


def u32(name: str, unit: str, default: int, low: int, high: int, *, live: bool = False) -> ParameterSpec:
    """Declare an integer parameter."""
    return ParameterSpec(
        name, unit, ParameterValue.u32(default), ParameterValue.u32(low), ParameterValue.u32(high), live
    )


def f32(name: str, unit: str, default: float, low: float, high: float, *, live: bool = False) -> ParameterSpec:
    """Declare a real parameter. Default and range are finite numbers."""
    if not all(math.isfinite(single(it)) for it in (default, low, high)):
        raise ValueError(f"{name}: {low} to {high} with the default {default}; all three are finite in binary32")
    return ParameterSpec(
        name, unit, ParameterValue.f32(default), ParameterValue.f32(low), ParameterValue.f32(high), live
    )


def choice(name: str, names: Sequence[str], default: str, *, live: bool = False) -> ParameterSpec:
    """Declare a parameter whose value is one of several names; its number is the index of the name."""
    if len(set(names)) != len(names) or len(names) > MOST_CHOICES or default not in names:
        raise ValueError(
            f"{name}: {len(names)} choices with the default {default}; a parameter has 1 to {MOST_CHOICES} different "
            "choices, and the default is one of them"
        )
    default_value, largest = ParameterValue.u32(names.index(default)), ParameterValue.u32(len(names) - 1)
    return ParameterSpec(name, "", default_value, ParameterValue.u32(0), largest, live, tuple(names))


def signal(name: str, unit: str) -> SignalSpec:
    """Declare a signal; an empty unit for a pure number."""
    return SignalSpec(name, unit)
