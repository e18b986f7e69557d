"""One run: a controller since arming, and the classification of samples by their sequence."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from lashloop.control import ControlInput, ControlOutput, InconsistentError, LiveController
from lashloop.counts import LARGEST, wrapping_difference
from lashloop.enums import TorqueFlags
from lashloop.errors import LashloopError
from lashloop.sequence import LONGEST_GAP, SEQUENCES

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from lashloop.control import ControlLaw
    from lashloop.messages import EncoderSample, TorqueAnswer


@dataclass(frozen=True, slots=True)
class Next:
    """A new sample, this many periods after the previous one; 1 for the first sample."""

    periods: int


@dataclass(frozen=True, slots=True)
class Repeated:
    """The previous sample again, with the answer to repeat."""

    answer: TorqueAnswer


@dataclass(frozen=True, slots=True)
class Stray:
    """A sample outside the sequence of this run."""


class SignalsError(LashloopError):
    """A law gives other signals than it declares: a defect of the law."""

    def __init__(self, law: str, given: Iterable[str], declared: Iterable[str]) -> None:
        """Name the law and both sets of signals."""
        lists = [", ".join(sorted(names)) or "no signal" for names in (given, declared)]
        super().__init__(f"the law {law} gave {lists[0]}; it declares {lists[1]}")


class UndeclaredError(LashloopError):
    """A law calls something inconsistent that isn't a parameter of the drive: a defect of the law."""

    def __init__(self, law: str, name: str) -> None:
        """Name the law and what it has named."""
        super().__init__(f"the law {law} calls {name} inconsistent, which isn't a parameter of the drive")


class Run:
    """A controller, and the sequence of its samples."""

    def __init__(self, law: ControlLaw, parameters: Mapping[str, float]) -> None:
        """Build the controller from the parameters in force.

        `InconsistentError` if they contradict each other, or if an encoder may exceed half its range in a period, so
        that its direction is ambiguous.
        """
        self._law = law
        self._signals = frozenset(it.name for it in law.signals)
        self._controller = law.build(parameters)
        period_s = parameters["period_us"] * 1e-6
        self._motor_rad_s_per_count = math.tau / (parameters["motor_counts_per_rev"] * period_s)
        self._load_rad_s_per_count = math.tau / (parameters["load_counts_per_rev"] * period_s)
        self._longest_gap = LONGEST_GAP
        for side, rad_s_per_count in (("motor", self._motor_rad_s_per_count), ("load", self._load_rad_s_per_count)):
            # An encoder may read one count more than its travel.
            fastest_rad_s = (LARGEST - 1) * rad_s_per_count
            periods = int(fastest_rad_s / parameters[f"{side}_speed_limit_rad_s"])
            if periods < 1:
                raise InconsistentError(f"{side}_speed_limit_rad_s")
            self._longest_gap = min(self._longest_gap, periods)
        self._before: EncoderSample | None = None
        self._motor_counts = self._load_counts = 0
        self.last_answer: TorqueAnswer | None = None

    def update(self, parameters: Mapping[str, float]) -> None:
        """Let the law take over live parameters; `InconsistentError` if they contradict each other."""
        if isinstance(self._controller, LiveController):
            self._controller.update(parameters)

    def classify(self, sequence: int, last: int | None) -> Next | Repeated | Stray:
        """Classify a sample by its sequence and that of the last sample taken."""
        if last is None:
            return Next(1) if sequence == 0 else Stray()
        ahead = (sequence - last) % SEQUENCES
        if ahead == 0 and self.last_answer is not None:
            status = self.last_answer.status
            status = replace(status, flags=status.flags | TorqueFlags.REPEATED)
            return Repeated(replace(self.last_answer, status=status))
        return Next(ahead) if 1 <= ahead <= self._longest_gap else Stray()

    def speeds(self, sample: EncoderSample, periods: int) -> tuple[float, float]:
        """Return the least possible speeds of motor and load since the previous sample, in rad/s, unsigned.

        One count is subtracted, because a difference of one count may result from a negligible travel.
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
        output = self._controller.step(
            ControlInput(self._motor_counts, self._load_counts, sample.reference_rad, applied_torque_nm, periods)
        )
        if output.signals.keys() != self._signals:
            raise SignalsError(self._law.name, output.signals, self._signals)
        return output
