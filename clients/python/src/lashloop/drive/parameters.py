"""The parameters of every drive, and the values in force.

Names, units, defaults and ranges are those of `docs/protocol/lashloop-drive.md`, so that scenarios written for the
firmware apply. The parameters of a control law are declared next to the law.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from lashloop.declarations import ParameterSpec, f32, u32

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from lashloop.enums import Outcome, ParameterValue

DRIVE_PARAMETERS: tuple[ParameterSpec, ...] = (
    u32("period_us", "us", 1000, 100, 100_000),
    u32("motor_counts_per_rev", "counts/rev", 131_072, 4, 16_777_216),
    u32("load_counts_per_rev", "counts/rev", 131_072, 4, 16_777_216),
    f32("torque_limit_nm", "N m", 20.0, 0.0, 1000.0),
    u32("watchdog_us", "us", 20_000, 200, 60_000_000),
    f32("motor_speed_limit_rad_s", "rad/s", 1000.0, 0.1, 1e6),
    f32("load_speed_limit_rad_s", "rad/s", 100.0, 0.1, 1e6),
)
"""Parameters of every drive, after `controller`."""


class Parameters(Mapping[str, float]):
    """The values in force: by name as numbers, by declaration as wire values."""

    def __init__(self, specs: Iterable[ParameterSpec]) -> None:
        """Start with the defaults of these parameters, which have different names."""
        self.specs = tuple(specs)
        self._values = {spec.name: spec.default for spec in self.specs}

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
        if outcome is outcome.ACCEPTED:
            self._values[spec.name] = value
        return outcome

    def restore_defaults(self) -> None:
        """Restore all defaults."""
        self._values = {spec.name: spec.default for spec in self.specs}
