"""The parameters of a drive: each declared once, with unit, default and range.

Parameters of every drive are declared here, those of a control law next to the law. Names, units, defaults and ranges
are those of section 14 of `docs/protocol.md`, so that scenarios written for the firmware apply.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.enums import Outcome, ParameterValue

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_LARGEST_COUNT = 255


@dataclass(frozen=True, slots=True)
class ParameterSpec:
    """Declaration of a parameter. Its index on the wire is its position in the table."""

    name: str
    unit: str
    default: ParameterValue
    min: ParameterValue
    max: ParameterValue
    live: bool = False

    def check(self, value: ParameterValue) -> Outcome:
        """Check type and range of a value."""
        if value.type is not self.default.type:
            return Outcome.WRONG_TYPE
        # NaN is outside every range.
        in_range = self.min.value <= value.value <= self.max.value
        return Outcome.ACCEPTED if in_range else Outcome.OUT_OF_RANGE


def u32(name: str, unit: str, default: int, low: int, high: int, *, live: bool = False) -> ParameterSpec:
    """Declare an integer parameter."""
    return ParameterSpec(
        name, unit, ParameterValue.u32(default), ParameterValue.u32(low), ParameterValue.u32(high), live
    )


def f32(name: str, unit: str, default: float, low: float, high: float) -> ParameterSpec:
    """Declare a real parameter."""
    return ParameterSpec(name, unit, ParameterValue.f32(default), ParameterValue.f32(low), ParameterValue.f32(high))


COMMON_PARAMETERS: tuple[ParameterSpec, ...] = (
    u32("period_us", "us", 1000, 100, 100_000),
    u32("motor_counts_per_rev", "counts/rev", 131_072, 4, 16_777_216),
    u32("load_counts_per_rev", "counts/rev", 131_072, 4, 16_777_216),
    f32("torque_limit_nm", "N m", 20.0, 0.0, 1000.0),
    u32("watchdog_us", "us", 20_000, 200, 60_000_000),
    f32("motor_speed_limit_rad_s", "rad/s", 1000.0, 0.1, 1e6),
    f32("load_speed_limit_rad_s", "rad/s", 100.0, 0.1, 1e6),
    u32("telemetry_every", "", 10, 0, 65_535, live=True),
)
"""Parameters of every drive, after `controller`."""


class Parameters(Mapping[str, float]):
    """The values in force: by name as numbers, by declaration as wire values."""

    def __init__(self, specs: Iterable[ParameterSpec]) -> None:
        """Start with the defaults; `ValueError` if names repeat or an index can't count them."""
        self.specs = tuple(specs)
        self._values = {spec.name: spec.default for spec in self.specs}
        if len(self._values) != len(self.specs) or len(self.specs) > _LARGEST_COUNT:
            raise ValueError(f"{len(self.specs)} parameters: at most {_LARGEST_COUNT}, each with its own name")

    def __len__(self) -> int:
        """Return the number of parameters."""
        return len(self.specs)

    def __getitem__(self, name: str) -> float:
        """Return the number in force."""
        return self._values[name].value

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self._values)

    def value(self, spec: ParameterSpec) -> ParameterValue:
        """Return the value in force."""
        return self._values[spec.name]

    def set(self, spec: ParameterSpec, value: ParameterValue) -> Outcome:
        """Set a value if it passes the check; otherwise nothing changes."""
        outcome = spec.check(value)
        if outcome is Outcome.ACCEPTED:
            self._values[spec.name] = value
        return outcome

    def restore_defaults(self) -> None:
        """Restore all defaults."""
        self._values = {spec.name: spec.default for spec in self.specs}
