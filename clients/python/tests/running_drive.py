"""A running drive, and its reaction to samples."""

from __future__ import annotations

from lashloop.enums import Outcome, ParameterValue, State, TorqueFlags
from lashloop.messages import (
    CommandResult,
    DriveMessage,
    EncoderSample,
    FaultReport,
    TorqueAnswer,
)
from support import DriveUnderTest, sample

SLOW = {"motor_speed_limit_rad_s": ParameterValue.f32(100.0)}  # so that encoders allow the longest gap there is


def torque(answers: list[DriveMessage]) -> TorqueAnswer:
    """The torque, which is sent first."""
    assert isinstance(answers[0], TorqueAnswer), answers
    return answers[0]


def fault(answers: list[DriveMessage]) -> FaultReport:
    """The fault report after a torque of zero."""
    first, second = answers
    assert isinstance(first, TorqueAnswer)
    assert (first.torque_nm, first.status.state) == (0.0, State.FAULTED)
    assert isinstance(second, FaultReport)
    return second


def running_at(*sequences: int) -> DriveUnderTest:
    """A running drive that has taken samples of these sequences."""
    dut = DriveUnderTest().running()
    for sequence in sequences:
        dut.send(sample(sequence))
    return dut


def classification(dut: DriveUnderTest, sequence: int) -> str:
    """Classification of a sample by the drive, in the terms of the specification's table."""
    (answer,) = dut.send(sample(sequence))
    if isinstance(answer, CommandResult):
        assert (answer.request, answer.outcome) == (EncoderSample.KIND, Outcome.OUT_OF_SEQUENCE)
        return "stray"
    assert isinstance(answer, TorqueAnswer)
    flags = answer.status.flags & ~TorqueFlags.SATURATED
    return {TorqueFlags(0): "taken", TorqueFlags.GAP: "after a gap", TorqueFlags.REPEATED: "repeated"}[flags]
