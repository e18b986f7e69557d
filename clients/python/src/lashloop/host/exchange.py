"""A sample for a torque, and the fault that may come in its place."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lashloop.host.errors import DriveFaultError, RefusedError
from lashloop.messages import CommandResult, DriveMessage, EncoderSample, FaultReport, TorqueAnswer
from lashloop.enums import Outcome, State

if TYPE_CHECKING:
    from lashloop.host.conversation import Conversation
    from lashloop.host.placed import PlacedFault


def exchange(talk: Conversation, sample: EncoderSample, limit_s: float) -> TorqueAnswer | None:
    """Send a sample and wait for its torque; None if none came in time.

    `DriveFaultError` if the run has ended by a fault, `RefusedError` if the drive refused the sample or is not running.
    """

    def wanted(message: DriveMessage) -> TorqueAnswer | None:
        # It will not answer any more: its watchdog has tripped, or these are its last words.
        if isinstance(message, FaultReport):
            raise DriveFaultError(reported_fault(talk))
        if isinstance(message, CommandResult) and message.request == EncoderSample.KIND:
            raise RefusedError("EncoderSample", message.outcome, message.state, [])
        if isinstance(message, TorqueAnswer) and message.sequence == sample.sequence:
            return message
        return None

    talk.send(sample)
    answer = talk.wait(wanted, limit_s)
    if answer is not None and answer.status.state is State.FAULTED:
        raise DriveFaultError(reported_fault(talk))
    if answer is not None and answer.status.state is not State.RUNNING:
        raise RefusedError("EncoderSample", Outcome.WRONG_STATE, answer.status.state, [])
    return answer


def reported_fault(talk: Conversation) -> PlacedFault:
    """Give the report of a fault that is known to be latched: it has come already, or follows."""
    if talk.fault is None:
        talk.wait(lambda it: it if isinstance(it, FaultReport) else None, talk.limits.request_s)
    if talk.fault is None:
        raise talk.silence("a state Faulted, for its FaultReport,", talk.limits.request_s)
    return talk.fault
