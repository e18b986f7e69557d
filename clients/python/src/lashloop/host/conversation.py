"""Requests and answers on a line: deadlines, and what comes in between."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from lashloop.decoder import Counters, Decoder
from lashloop.frames import DELIMITER, FROM_DRIVE, FrameError, encode
from lashloop.host.errors import SilenceError
from lashloop.host.placed import Placed, PlacedFault
from lashloop.lines import send_all
from lashloop.messages import DriveMessage, EncoderSample, FaultReport, HostMessage, Log, Telemetry, TorqueAnswer
from lashloop.sequence import nearest_step

if TYPE_CHECKING:
    from collections.abc import Callable

    from lashloop.lines import Line

T = TypeVar("T")

_LOGS_KEPT = 100


@dataclass(frozen=True, slots=True)
class TimeLimits:
    """How long a host waits, section 11 of `docs/protocol.md`. Wall time.

    The Lashloop bench, of which that section tells, sends a request again every 500 ms; this host sends each of them
    once and waits for its answer. Only a `Hello` and the first sample of a run are sent again.
    """

    greeting_s: float = 2.5
    """For an `Identity`."""
    hello_every_s: float = 0.1
    """Between two greetings."""
    request_s: float = 2.0
    """For the answer to any other request, and for the far end to take it."""
    answer_s: float = 1.0
    """For a torque; then the last one is held."""
    silence_s: float = 2.5
    """For the first torque after one that is missing."""


class Conversation:
    """A line with a drive at its far end."""

    def __init__(self, line: Line, limits: TimeLimits, clock: Callable[[], float] = time.monotonic) -> None:
        """Use an open line; nothing is sent yet."""
        self.limits = limits
        self.clock = clock
        self.telemetry: Placed[Telemetry] | None = None
        self.fault: PlacedFault | None = None
        self.logs: deque[Log] = deque(maxlen=_LOGS_KEPT)
        self.last_torque: int | None = None
        """The control period of the last torque of the run that came at all, in time or late."""
        self._line = line
        self._decoder = Decoder(FROM_DRIVE)
        self._inbox: deque[DriveMessage] = deque()
        self._last_sent: int | None = None
        self._last_message = ""

    @property
    def counters(self) -> Counters:
        """What this end's receiver has seen."""
        return self._decoder.counters

    def begin_run(self) -> None:
        """Count the samples anew, and forget what was told of the run before."""
        self.telemetry = self._last_sent = self.last_torque = None

    def clear(self) -> None:
        """Begin anew: forget what has come, and end whatever half frame an earlier host left with the drive."""
        self._line.discard_input()
        self._decoder = Decoder(FROM_DRIVE)
        self._inbox.clear()
        send_all(self._line, DELIMITER, self.limits.request_s, self.clock)

    def send(self, message: HostMessage) -> None:
        """Send a message and wait for nothing."""
        send_all(self._line, encode(message), self.limits.request_s, self.clock)
        if isinstance(message, EncoderSample):
            self._last_sent = nearest_step(message.sequence, self._last_sent or 0)

    def wait(self, wanted: Callable[[DriveMessage], T | None], limit_s: float) -> T | None:
        """Give what `wanted` recognises, or None once the time is over. Everything else is kept or passed over."""
        deadline = self.clock() + limit_s
        over = False
        while True:
            while self._inbox:
                message = self._inbox.popleft()
                self._note(message)
                answer = wanted(message)
                if answer is not None:
                    return answer
            if over:
                return None
            left_s = deadline - self.clock()
            # What is there already is still read after the deadline, once.
            over = left_s <= 0
            data = self._line.read(max(left_s, 0.0))
            self._inbox.extend(it for it in self._decoder.feed(data) if not isinstance(it, FrameError))

    def ask(self, request: HostMessage, wanted: Callable[[DriveMessage], T | None]) -> T:
        """Send a request once and wait for its answer; `SilenceError` if none comes."""
        self.send(request)
        answer = self.wait(wanted, self.limits.request_s)
        if answer is None:
            raise self.silence(type(request).__name__, self.limits.request_s)
        return answer

    def silence(self, waiting_for: str, limit_s: float) -> SilenceError:
        """Give the error for an answer that did not come."""
        return SilenceError(waiting_for, limit_s, self._last_seen())

    def close(self) -> None:
        """Let go of the line."""
        self._line.close()

    def _note(self, message: DriveMessage) -> None:
        self._last_message = type(message).__name__
        match message:
            case Log():
                self.logs.append(message)
            case FaultReport():
                self.fault = PlacedFault.near(self._last_sent, message)
            case Telemetry():
                self.telemetry = Placed.near(self._last_sent or 0, message)
            case TorqueAnswer():
                self.last_torque = Placed.near(self._last_sent or 0, message).step

    def _last_seen(self) -> str:
        if not self._last_message:
            damaged = self.counters.damaged + self.counters.refused
            return f"no good frame received, {damaged} bad ones"
        if self._last_sent is None:
            return f"last frame received: {self._last_message}"
        return (
            f"last sample sent: {self._last_sent}, last torque: {self.last_torque}, "
            f"last frame received: {self._last_message}"
        )
