"""A run in lockstep: a sample for each control period, a torque for each sample."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lashloop.counts import wrapped
from lashloop.host.errors import GapTooLongError, StartTooFarError
from lashloop.host.exchange import exchange
from lashloop.host.placed import Placed
from lashloop.messages import EncoderSample
from lashloop.sequence import LONGEST_GAP, of_step

if TYPE_CHECKING:
    from lashloop.host.conversation import Conversation
    from lashloop.messages import TorqueAnswer


class Lockstep:
    """The control periods of a run, counted by the calls of `torque`."""

    def __init__(self, talk: Conversation) -> None:
        """Be at the first sample; what comes from now on is of this run."""
        talk.begin_run()
        self._talk = talk
        self._step = 0
        self._held_nm = 0.0
        self._unanswered_since: float | None = None
        self.last_answer: Placed[TorqueAnswer] | None = None
        self.lost = 0

    def torque(self, motor_counts: int, load_counts: int, reference_rad: float) -> float:
        """See `Host.torque`."""
        self._check(motor=motor_counts, load=load_counts)
        sample = EncoderSample(of_step(self._step), wrapped(motor_counts), wrapped(load_counts), reference_rad)
        limits, clock = self._talk.limits, self._talk.clock
        since = clock() if self._unanswered_since is None else self._unanswered_since
        self._unanswered_since = since
        while (patience_s := limits.silence_s - (clock() - since)) > 0:
            answer = exchange(self._talk, sample, min(limits.answer_s, patience_s))
            if answer is not None:
                self._unanswered_since = None
                self.last_answer = Placed(self._step, answer)
                self._held_nm = answer.torque_nm
                self._step += 1
                return self._held_nm
            # The first one is sent again, the same bytes: no other can be the first.
            if self._step > 0 and clock() - since < limits.silence_s:
                self.lost += 1
                self._step += 1
                return self._held_nm
        first = 0 if self.last_answer is None else self.last_answer.step + 1
        raise self._talk.silence(f"EncoderSample {first}", limits.silence_s)

    def _check(self, **positions: int) -> None:
        """Find what no drive can make sense of, before anything is sent."""
        # A late answer gives no torque, but the drive has taken its sample.
        taken = self._talk.last_torque
        if taken is not None and self._step - taken > LONGEST_GAP:
            raise GapTooLongError(taken, LONGEST_GAP)
        for side, counts in positions.items():
            if self._step == 0 and wrapped(counts) != counts:
                raise StartTooFarError(side, counts)
