"""The exchange of a sample for a torque, or for the fault that ends the run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lashloop.enums import Outcome, State
from lashloop.host.errors import DriveFaultError, RejectedError
from lashloop.host.names import named_fault, rejection
from lashloop.messages import CommandResult, DriveMessage, EncoderSample, FaultReport, TorqueAnswer

if TYPE_CHECKING:
    from lashloop.host.at_step import FaultAtStep
    from lashloop.host.line import DriveLine


def exchange(line: DriveLine, sample: EncoderSample, limit_s: float) -> TorqueAnswer | None:
    """Send a sample and return its torque, or None after the timeout.

    `DriveFaultError` if a fault has ended the run, `RejectedError` if the drive rejects the sample or is not running.
    """

    def wanted(message: DriveMessage) -> TorqueAnswer | None:
        # No answer follows: the watchdog has tripped, or the firmware has stopped.
        if isinstance(message, FaultReport):
            raise DriveFaultError(reported_fault(line))
        if isinstance(message, CommandResult) and message.request == EncoderSample.KIND:
            raise rejection(line, sample, message)
        if isinstance(message, TorqueAnswer) and message.sequence == sample.sequence:
            return message
        return None

    line.send(sample)
    answer = line.wait(wanted, limit_s)
    if answer is not None and answer.status.state is State.FAULTED:
        raise DriveFaultError(reported_fault(line))
    if answer is not None and answer.status.state is not State.RUNNING:
        raise RejectedError("EncoderSample", Outcome.WRONG_STATE, answer.status.state)
    return answer


def reported_fault(line: DriveLine) -> FaultAtStep:
    """Return the report of a latched fault, received already or still to come."""
    if line.fault is None:
        line.wait(lambda it: it if isinstance(it, FaultReport) else None, line.limits.request_s)
    fault = named_fault(line)
    if fault is None:
        raise line.silence("a state Faulted, for its FaultReport,", line.limits.request_s)
    return fault
