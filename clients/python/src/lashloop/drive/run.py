"""One run: a controller from its arming on, and where each sample stands in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from lashloop.control import ControlInput, Controller, ControlOutput
from lashloop.counts import wrapping_difference
from lashloop.vocabulary import TorqueFlags

if TYPE_CHECKING:
    from collections.abc import Mapping

    from lashloop.messages import EncoderSample, TorqueAnswer

LARGEST_GAP = 1000
"""Samples that may be missing in a row before a sequence is taken for a stray frame of another run."""


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
        """Take a controller that has seen nothing yet, and the parameters at its arming."""
        self._controller = controller
        period_s = parameters["period_us"] * 1e-6
        self._motor_rad_s_per_count = math.tau / (parameters["motor_counts_per_rev"] * period_s)
        self._load_rad_s_per_count = math.tau / (parameters["load_counts_per_rev"] * period_s)
        self._before: EncoderSample | None = None
        self.last_answer: TorqueAnswer | None = None

    def place(self, sequence: int, last: int | None) -> Next | Repeated | Stray:
        """Say where a sample of this sequence stands, given that of the last one taken."""
        if last is None:
            return Next(1) if sequence == 0 else Stray()
        ahead = (sequence - last) % 2**32
        if ahead == 0 and self.last_answer is not None:
            return Repeated(replace(self.last_answer, flags=self.last_answer.flags | TorqueFlags.REPEATED))
        return Next(ahead) if 1 <= ahead <= LARGEST_GAP else Stray()

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
        self._before = sample
        return self._controller.step(
            ControlInput(sample.motor_counts, sample.load_counts, sample.reference_rad, applied_torque_nm, periods)
        )
