"""A run in lockstep: one sample per control period, one torque per sample."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lashloop.counts import wrapped
from lashloop.host.at_step import AtStep
from lashloop.host.errors import GapTooLongError, StartTooFarError
from lashloop.host.exchange import exchange
from lashloop.messages import EncoderSample
from lashloop.sequence import LONGEST_GAP, of_step

if TYPE_CHECKING:
    from lashloop.host.line import DriveLine
    from lashloop.messages import TorqueAnswer


class Lockstep:
    """The control periods of a run, counted by the calls of `torque`."""

    def __init__(self, line: DriveLine) -> None:
        """Start before the first sample."""
        line.begin_run()
        self._line = line
        self._step = 0
        self._held_nm = 0.0
        self._unanswered_since: float | None = None
        self.last_answer: AtStep[TorqueAnswer] | None = None
        self.lost = 0

    def torque(self, motor_counts: int, load_counts: int, reference_rad: float) -> float:
        """See `Host.torque`."""
        self._check(motor=motor_counts, load=load_counts)
        sample = EncoderSample(of_step(self._step), wrapped(motor_counts), wrapped(load_counts), reference_rad)
        limits, clock = self._line.limits, self._line.clock
        since = clock() if self._unanswered_since is None else self._unanswered_since
        self._unanswered_since = since
        while (left_s := limits.silence_s - (clock() - since)) > 0:
            answer = exchange(self._line, sample, min(limits.answer_s, left_s))
            if answer is not None:
                self._unanswered_since = None
                self.last_answer = AtStep(self._step, answer)
                self._held_nm = answer.torque_nm
                self._step += 1
                return self._held_nm
            # The first sample is retransmitted unchanged, because the drive requires sequence 0.
            if self._step > 0 and clock() - since < limits.silence_s:
                self.lost += 1
                self._step += 1
                return self._held_nm
        first = 0 if self.last_answer is None else self.last_answer.step + 1
        raise self._line.silence(f"EncoderSample {first}", limits.silence_s)

    def _check(self, **positions: int) -> None:
        """Reject samples that no drive accepts, before sending."""
        # A late answer yields no torque, but the drive has taken its sample.
        taken = self._line.last_torque
        if taken is not None and self._step - taken > LONGEST_GAP:
            raise GapTooLongError(taken, LONGEST_GAP)
        for side, counts in positions.items():
            if self._step == 0 and wrapped(counts) != counts:
                raise StartTooFarError(side, counts)
