"""A drive that runs, and what it makes of samples."""

from __future__ import annotations

from lashloop.messages import (
    CommandResult,
    DriveMessage,
    EncoderSample,
    FaultReport,
    TorqueAnswer,
)
from lashloop.enums import Outcome, ParameterValue, State, TorqueFlags
from support import Bench, sample

QUIET = {"telemetry_every": ParameterValue.u32(0)}
SLOW = {"motor_speed_limit_rad_s": ParameterValue.f32(100.0)}  # so that encoders allow the longest gap there is


def torque(answers: list[DriveMessage]) -> TorqueAnswer:
    """The torque, which comes first."""
    assert isinstance(answers[0], TorqueAnswer), answers
    return answers[0]


def fault(answers: list[DriveMessage]) -> FaultReport:
    """The fault behind a torque of zero."""
    first, second = answers
    assert isinstance(first, TorqueAnswer)
    assert (first.torque_nm, first.status.state) == (0.0, State.FAULTED)
    assert isinstance(second, FaultReport)
    return second


def running_at(*sequences: int) -> Bench:
    """A running drive that has taken these."""
    bench = Bench().running(**QUIET)
    for sequence in sequences:
        bench.say(sample(sequence))
    return bench


def place(bench: Bench, sequence: int) -> str:
    """What the drive makes of a sequence, in the words of the specification's table."""
    (answer,) = bench.say(sample(sequence))
    if isinstance(answer, CommandResult):
        assert (answer.request, answer.outcome) == (EncoderSample.KIND, Outcome.OUT_OF_SEQUENCE)
        return "stray"
    assert isinstance(answer, TorqueAnswer)
    flags = answer.status.flags & ~TorqueFlags.SATURATED
    return {TorqueFlags(0): "taken", TorqueFlags.GAP: "after a gap", TorqueFlags.REPEATED: "repeated"}[flags]
