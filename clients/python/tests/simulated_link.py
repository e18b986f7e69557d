"""A link between a host and a drive in one process, with a virtual clock, that can lose messages."""

from __future__ import annotations

from collections import Counter, deque
from typing import TYPE_CHECKING

from lashloop.frames import FROM_DRIVE, FROM_HOST, Numbered, decode, encode
from lashloop.host import Host, TimeLimits
from support import DriveUnderTest

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from lashloop.messages import DriveMessage, HostMessage

    Altered = Sequence[DriveMessage | Numbered[DriveMessage] | bytes]


class SimulatedLink:
    """A link to a drive. Time advances only while the host waits."""

    def __init__(self) -> None:
        """Power up a drive and connect it."""
        self.dut = DriveUnderTest()
        self.now_s = 0.0
        self.sent: list[HostMessage] = []
        self.numbers: list[int] = []
        """Numbers of the messages sent."""
        self.closed = False
        self.delay_s = 0.0
        self.loses_request: Callable[[HostMessage], bool] = lambda _: False
        self.alters: Callable[[DriveMessage], Altered] = lambda it: [it]
        """What arrives of a message of the drive: messages with its number, messages with another one, and frames."""
        self.number = 0
        """Number of the message that `alters` gets."""
        self._under_way: deque[tuple[float, bytes]] = deque()
        self._coming = bytearray(b"\x17 half a frame of an earlier host")

    def clock(self) -> float:
        """The host's time."""
        return self.now_s

    def write(self, data: bytes, timeout_s: float) -> int:
        """Pass the bytes to the drive, unless they are lost."""
        del timeout_s
        for frame in data.split(b"\0")[:-1]:
            if frame:
                item = decode(frame, FROM_HOST)
                self.sent.append(item.message)
                self.numbers.append(item.number)
                if not self.loses_request(item.message):
                    self._answer(self.dut.drive.receive(frame + b"\0"))
        return len(data)

    def _answer(self, data: bytes) -> None:
        for frame in data.split(b"\0")[:-1]:
            item = decode(frame, FROM_DRIVE)
            self.number = item.number
            for it in self.alters(item.message):
                self._under_way.append((self.now_s + self.delay_s, self._frame(it)))

    def _frame(self, altered: DriveMessage | Numbered[DriveMessage] | bytes) -> bytes:
        if isinstance(altered, bytes):
            return altered
        if isinstance(altered, Numbered):
            return encode(altered.message, altered.number)
        return encode(altered, self.number)

    def _arrive(self) -> None:
        while self._under_way and self._under_way[0][0] <= self.now_s:
            self._coming += self._under_way.popleft()[1]

    def read(self, timeout_s: float) -> bytes:
        """Return received bytes, or advance the time of both sides."""
        self._arrive()
        if not self._coming:
            left_s = self.dut.drive.time_left_s
            waited_s = timeout_s if left_s is None else min(timeout_s, left_s + 1e-6)
            if self._under_way:
                waited_s = min(waited_s, self._under_way[0][0] - self.now_s)
            self.now_s += waited_s
            self.dut.clock.pass_us(waited_s * 1e6)
            self._answer(self.dut.drive.tick())
            self._arrive()
        data, self._coming = bytes(self._coming[:7]), self._coming[7:]
        return data

    def discard_input(self) -> None:
        """Discard received bytes."""
        self._arrive()
        self._coming.clear()

    def close(self) -> None:
        """Record the call."""
        self.closed = True

    def count(self, kind: type[HostMessage]) -> int:
        """Number of messages of a kind sent."""
        return Counter(map(type, self.sent))[kind]


def opened(link: SimulatedLink, limits: TimeLimits | None = None) -> Host:
    """A host with a fixed session number."""
    return Host(link, session=7, limits=limits, clock=link.clock)


def running(link: SimulatedLink, limits: TimeLimits | None = None) -> Host:
    """A host in a run, with a watchdog longer than the host's timeouts."""
    host = opened(link, limits)
    host.set("watchdog_us", 10_000_000)
    host.subscribe()
    host.arm()
    host.start()
    return host


def step(host: Host) -> float:
    """A sample of mechanics at rest, away from the reference."""
    return host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)
