"""Requests and answers on a link, with deadlines; other messages in between are recorded."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from lashloop.decoder import Counters, Decoder
from lashloop.frames import DELIMITER, FROM_DRIVE, Numbered, encode
from lashloop.host.at_step import AtStep, FaultAtStep, TelemetryAtStep
from lashloop.host.errors import SilenceError
from lashloop.layout import has_number
from lashloop.link import send_all
from lashloop.messages import DriveMessage, EncoderSample, FaultReport, HostMessage, Log, Telemetry, TorqueAnswer
from lashloop.sequence import nearest_step

if TYPE_CHECKING:
    from collections.abc import Callable

    from lashloop.link import Link

T = TypeVar("T")

_LOGS_KEPT = 100
_LARGEST_NUMBER = 255


@dataclass(frozen=True, slots=True)
class TimeLimits:
    """Timeouts of a host in wall-clock time, section 13 of `docs/protocol.md`.

    The Lashloop bench retransmits a request every 500 ms. This host retransmits only `Hello` and the first sample of a
    run; it sends any other request once.
    """

    handshake_s: float = 2.5
    """Until the `Identity`."""
    hello_every_s: float = 0.1
    """Between two `Hello` messages."""
    request_s: float = 2.0
    """Until the answer to any other request, and until the far end accepts it."""
    answer_s: float = 1.0
    """Until a torque; then the previous torque is held."""
    silence_s: float = 2.5
    """Without any torque in time; then the run fails."""


class DriveLine:
    """A link to a drive, with the last messages received."""

    def __init__(self, link: Link, limits: TimeLimits, clock: Callable[[], float] = time.monotonic) -> None:
        """Use an open link; nothing is sent yet."""
        self.limits = limits
        self.clock = clock
        self.telemetry: TelemetryAtStep | None = None
        self.subscription: tuple[str, ...] = ()
        """Names of the signals of the telemetry, in its order; empty if unknown."""
        self.fault: FaultAtStep | None = None
        self.logs: deque[Log] = deque(maxlen=_LOGS_KEPT)
        self.last_torque: int | None = None
        """Control period of the last torque of the run, in time or late."""
        self._link = link
        self._decoder = Decoder(FROM_DRIVE)
        self._inbox: deque[Numbered[DriveMessage]] = deque()
        self._last_number = 0
        self._last_sent: int | None = None
        self._last_message = ""

    @property
    def counters(self) -> Counters:
        """Receive statistics of the host."""
        return self._decoder.counters

    def begin_run(self) -> None:
        """Restart the count of samples and discard the data of the previous run."""
        self.telemetry = self._last_sent = self.last_torque = None

    def clear(self) -> None:
        """Discard received bytes, and end a partial frame that an earlier host left in the drive's receiver."""
        self._link.discard_input()
        self._decoder = Decoder(FROM_DRIVE)
        self._inbox.clear()
        send_all(self._link, DELIMITER, self.limits.request_s, self.clock)

    def next_number(self) -> int:
        """Return the number of the next request: 1 to 255 in turn. A request that is sent again keeps its number."""
        self._last_number = self._last_number % _LARGEST_NUMBER + 1
        return self._last_number

    def send(self, message: HostMessage, number: int = 0) -> None:
        """Send a message without waiting for an answer. Samples have no number."""
        send_all(self._link, encode(message, number), self.limits.request_s, self.clock)
        if isinstance(message, EncoderSample):
            self._last_sent = nearest_step(message.sequence, self._last_sent or 0)

    def wait(self, wanted: Callable[[DriveMessage], T | None], limit_s: float, number: int = 0) -> T | None:
        """Return the first result of `wanted`, or None after the timeout. Other messages are recorded.

        An answer of another number than that of the request is late and answers nothing.
        """
        deadline = self.clock() + limit_s
        expired = False
        while True:
            while self._inbox:
                item = self._inbox.popleft()
                self._record(item.message)
                is_late = has_number(item.message.KIND) and item.number != number
                answer = None if is_late else wanted(item.message)
                if answer is not None:
                    return answer
            if expired:
                return None
            left_s = deadline - self.clock()
            # Bytes already received are read once more after the deadline.
            expired = left_s <= 0
            data = self._link.read(max(left_s, 0.0))
            self._inbox.extend(it for it in self._decoder.feed(data) if isinstance(it, Numbered))

    def request(self, message: HostMessage, wanted: Callable[[DriveMessage], T | None]) -> T:
        """Send a request once and return its answer; `SilenceError` after the timeout."""
        number = self.next_number()
        self.send(message, number)
        answer = self.wait(wanted, self.limits.request_s, number)
        if answer is None:
            raise self.silence(type(message).__name__, self.limits.request_s)
        return answer

    def silence(self, waiting_for: str, limit_s: float) -> SilenceError:
        """Return the error for a missing answer."""
        return SilenceError(waiting_for, limit_s, self._last_seen())

    def close(self) -> None:
        """Close the link."""
        self._link.close()

    def _record(self, message: DriveMessage) -> None:
        self._last_message = type(message).__name__
        match message:
            case Log():
                self.logs.append(message)
            case FaultReport():
                self.fault = FaultAtStep.near(self._last_sent, message)
            case Telemetry():
                self.telemetry = TelemetryAtStep.near(self._last_sent or 0, message, self.subscription)
            case TorqueAnswer():
                self.last_torque = AtStep.near(self._last_sent or 0, message).step

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
