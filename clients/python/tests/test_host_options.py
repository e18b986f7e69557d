"""Requests of a host to a drive that stores parameters, has encoders and captures signals."""

from __future__ import annotations

import pytest

from lashloop.enums import CaptureTrigger, Outcome, ZeroSource
from lashloop.host import Captured, RejectedError, UnknownSignalError
from lashloop.messages import (
    Capture,
    CaptureRows,
    CommandResult,
    DescribeParameter,
    DriveMessage,
    ForgetParameters,
    ReadCapture,
    RecallParameters,
    SetZero,
    StoreParameters,
)
from simulated_link import SimulatedLink, opened

ROWS = tuple((0.5 * row, float(row)) for row in range(15))
PER_MESSAGE = 6


def with_options() -> SimulatedLink:
    """A link to a drive with these options, which has captured 15 rows."""
    link = SimulatedLink()

    def alters(message: DriveMessage) -> list[DriveMessage]:
        if not isinstance(message, CommandResult) or message.outcome is not Outcome.UNKNOWN_REQUEST:
            return [message]
        request = link.sent[-1]
        if not isinstance(request, ReadCapture):
            return [CommandResult(message.request, Outcome.ACCEPTED, message.state)]
        rows = ROWS[request.first : request.first + PER_MESSAGE]
        if not rows:
            return [CommandResult(message.request, Outcome.UNKNOWN_INDEX, message.state, len(ROWS))]
        return [CaptureRows(request.first, 3, tuple(value for row in rows for value in row))]

    link.alters = alters
    return link


def test_stored_parameters_are_described_anew() -> None:
    link = with_options()
    host = opened(link)
    for number, (request, call) in enumerate(
        [(StoreParameters, host.store_parameters), (ForgetParameters, host.forget_parameters)], start=2
    ):
        count = len(host.parameters)
        call()
        assert link.sent[-1] == request()
        assert (len(host.parameters), link.count(DescribeParameter)) == (count, number * count)
    host.recall_parameters()
    assert link.sent[-1] == RecallParameters()


def test_the_zero_is_here_or_at_the_home_switch() -> None:
    link = with_options()
    host = opened(link)
    host.set_zero()
    host.set_zero(ZeroSource.HOME)
    assert link.sent[-2:] == [SetZero(ZeroSource.PRESENT), SetZero(ZeroSource.HOME)]


def test_a_capture_has_the_values_of_its_signals_by_name() -> None:
    link = with_options()
    host = opened(link)
    names = list(host.signals)[:2]
    # In the order of the drive, whichever the order of the names.
    assert host.capture(reversed(names), every=2, before=3, of=names[1], trigger=CaptureTrigger.RISING, level=0.25)
    assert link.sent[-1] == Capture(0b11, 2, 3, CaptureTrigger.RISING, 1, 0.25)
    captured = host.read_capture()
    assert captured == Captured(tuple(names), 2, 3, ROWS)
    assert captured[names[1]] == tuple(float(row) for row in range(15))
    assert [it.first for it in link.sent if isinstance(it, ReadCapture)] == [0, 6, 12, 15]
    with pytest.raises(KeyError):
        captured["nothing"]


def test_no_signal_ends_a_capture_and_an_unknown_one_is_an_error() -> None:
    link = with_options()
    host = opened(link)
    host.capture([])
    assert link.sent[-1] == Capture(0, 1, 0, CaptureTrigger.NOW, 0, 0.0)
    with pytest.raises(UnknownSignalError):
        host.capture(["nothing"])


@pytest.mark.parametrize(
    ("outcome", "detail", "words"),
    [
        (Outcome.NOT_CAPTURED, 0, "NotCaptured$"),
        (Outcome.NOT_CAPTURED, 1, r"NotCaptured \(the event has not come yet\)"),
        (Outcome.UNKNOWN_REQUEST, 0, "UnknownRequest"),
    ],
)
def test_what_is_not_captured_is_rejected_with_the_reason(outcome: Outcome, detail: int, words: str) -> None:
    link = SimulatedLink()

    def alters(message: DriveMessage) -> list[DriveMessage]:
        if isinstance(message, CommandResult) and message.request == ReadCapture.KIND:
            return [CommandResult(message.request, outcome, message.state, detail)]
        return [message]

    link.alters = alters
    with pytest.raises(RejectedError, match=words):
        opened(link).read_capture()
