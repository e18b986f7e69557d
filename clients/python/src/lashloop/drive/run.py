"""One run: a controller from its arming on, and where each sample stands in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from lashloop.control import ControlInput, Controller, ControlOutput, InconsistentError
from lashloop.counts import LARGEST, wrapping_difference
from lashloop.sequence import LONGEST_GAP, SEQUENCES
from lashloop.enums import TorqueFlags

if TYPE_CHECKING:
    from collections.abc import Mapping

    from lashloop.messages import EncoderSample, TorqueAnswer


@dataclass(frozen=True, slots=True)
class Next:
    """A new sample, this many periods after the one before; the first one counts as one."""

    periods: int


@dataclass(frozen=True, slots=True)
class Repeated:
    """The sample before, again, with the answer to be given again."""

    answer: TorqueAnswer


@dataclass(frozen=True, slots=True)
class Stray:
    """A sample of another run."""


class Run:
    """A controller at work."""

    def __init__(self, controller: Controller, parameters: Mapping[str, float]) -> None:
        """Take a controller that has seen nothing yet, and the parameters at its arming.

        `InconsistentError` if an encoder may turn so far in a period that nobody could say which way.
        """
        self._controller = controller
        period_s = parameters["period_us"] * 1e-6
        self._motor_rad_s_per_count = math.tau / (parameters["motor_counts_per_rev"] * period_s)
        self._load_rad_s_per_count = math.tau / (parameters["load_counts_per_rev"] * period_s)
        self._longest_gap = LONGEST_GAP
        for side, rad_s_per_count in (("motor", self._motor_rad_s_per_count), ("load", self._load_rad_s_per_count)):
            # An encoder may show one count more than it has turned.
            fastest_rad_s = (LARGEST - 1) * rad_s_per_count
            periods = int(fastest_rad_s / parameters[f"{side}_speed_limit_rad_s"])
            if periods < 1:
                raise InconsistentError(f"{side}_speed_limit_rad_s")
            self._longest_gap = min(self._longest_gap, periods)
        self._before: EncoderSample | None = None
        self._motor_counts = self._load_counts = 0
        self.last_answer: TorqueAnswer | None = None

    def place(self, sequence: int, last: int | None) -> Next | Repeated | Stray:
        """Say where a sample of this sequence stands, given that of the last one taken."""
        if last is None:
            return Next(1) if sequence == 0 else Stray()
        ahead = (sequence - last) % SEQUENCES
        if ahead == 0 and self.last_answer is not None:
            status = self.last_answer.status
            status = replace(status, flags=status.flags | TorqueFlags.REPEATED)
            return Repeated(replace(self.last_answer, status=status))
        return Next(ahead) if 1 <= ahead <= self._longest_gap else Stray()

    def speeds(self, sample: EncoderSample, periods: int) -> tuple[float, float]:
        """How fast motor and load must have turned at least since the sample before, in rad/s, either way.

        A count is taken off: an encoder that shows one count more may have turned hardly at all.
        """
        if self._before is None:
            return 0.0, 0.0
        motor = abs(wrapping_difference(sample.motor_counts, self._before.motor_counts))
        load = abs(wrapping_difference(sample.load_counts, self._before.load_counts))
        return (
            max(motor - 1, 0) * self._motor_rad_s_per_count / periods,
            max(load - 1, 0) * self._load_rad_s_per_count / periods,
        )

    def step(self, sample: EncoderSample, periods: int, applied_torque_nm: float) -> ControlOutput:
        """Make one control step."""
        if self._before is None:
            self._motor_counts, self._load_counts = sample.motor_counts, sample.load_counts
        else:
            self._motor_counts += wrapping_difference(sample.motor_counts, self._before.motor_counts)
            self._load_counts += wrapping_difference(sample.load_counts, self._before.load_counts)
        self._before = sample
        return self._controller.step(
            ControlInput(self._motor_counts, self._load_counts, sample.reference_rad, applied_torque_nm, periods)
        )
