"""A drive that describes everything the protocol allows, so that `lashloop conformance` omits no check.

It has two laws with signals of their own, more signals than a telemetry holds, choices and a live parameter. The law
that is in force after power-up is `pd`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lashloop.control import ControlInput, ControlLaw, ControlOutput, choice, f32, signal
from lashloop.control.cascade import PD
from lashloop.drive import Drive, serve
from lashloop.limits import MAX_TELEMETRY_VALUES
from lashloop.link import StandardStreams

if TYPE_CHECKING:
    from collections.abc import Mapping

NAMES = [f"other_{number}_nm" for number in range(MAX_TELEMETRY_VALUES + 1)]


class Other:
    """A law with a constant torque and many signals."""

    def __init__(self, parameters: Mapping[str, float]) -> None:
        """Keep the parameters in force."""
        self._parameters = parameters

    def step(self, sample: ControlInput) -> ControlOutput:
        """Return the torque in the chosen direction."""
        del sample
        torque_nm = self._parameters["other_nm"] * (1.0 if self._parameters["other_direction"] == 0 else -1.0)
        return ControlOutput(torque_nm, {name: place + torque_nm for place, name in enumerate(NAMES)})


OTHER = ControlLaw(
    name="other",
    parameters=(
        f32("other_nm", "N m", default=0.5, low=0.0, high=2.0, live=True),
        choice("other_direction", ["forwards", "backwards"], default="forwards"),
    ),
    signals=tuple(signal(name, "N m") for name in NAMES),
    build=Other,
)

if __name__ == "__main__":
    serve(StandardStreams(), Drive([PD, OTHER]))
