"""A drive in each state, and the reaction of a running drive to samples."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from lashloop.control import u32
from lashloop.control.cascade import PD
from lashloop.enums import Outcome, ParameterValue, State, TorqueFlags
from lashloop.messages import (
    CommandResult,
    DriveMessage,
    EmergencyStop,
    EncoderSample,
    FaultReport,
    TorqueAnswer,
)
from support import DriveUnderTest, sample

if TYPE_CHECKING:
    from collections.abc import Callable

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


TUNED = replace(PD, parameters=(*PD.parameters, u32("tuning", "", 10, 0, 10, live=True)))
"""The law with a live parameter after its own."""


def faulted() -> DriveUnderTest:
    """A drive with a session and a latched emergency stop."""
    dut = DriveUnderTest(laws=[TUNED]).idle()
    dut.send(EmergencyStop())
    return dut


ENTER: dict[str, Callable[[], DriveUnderTest]] = {
    "Boot": lambda: DriveUnderTest(laws=[TUNED]),
    "Idle": lambda: DriveUnderTest(laws=[TUNED]).idle(),
    "Armed": lambda: DriveUnderTest(laws=[TUNED]).armed(),
    "Running": lambda: DriveUnderTest(laws=[TUNED]).running(),
    "Faulted": faulted,
}
"""Enters each state, by its name."""
