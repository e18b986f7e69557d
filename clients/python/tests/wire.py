"""A line between a host and a drive in the same process that can lose what is sent, with a clock of its own."""

from __future__ import annotations

from collections import Counter, deque
from typing import TYPE_CHECKING

from lashloop.frames import FROM_DRIVE, FROM_HOST, decode, encode
from lashloop.host import Host, TimeLimits
from support import Bench

if TYPE_CHECKING:
    from collections.abc import Callable

    from lashloop.messages import DriveMessage, HostMessage


class Wire:
    """A line to a drive. Time passes only while the host waits for what does not come."""

    def __init__(self) -> None:
        """Power a drive and connect it."""
        self.bench = Bench()
        self.now_s = 0.0
        self.sent: list[HostMessage] = []
        self.closed = False
        self.delay_s = 0.0
        self.loses_request: Callable[[HostMessage], bool] = lambda _: False
        self.alters: Callable[[DriveMessage], list[DriveMessage]] = lambda it: [it]
        self._under_way: deque[tuple[float, bytes]] = deque()
        self._coming = bytearray(b"\x17 half a frame of an earlier host")

    def clock(self) -> float:
        """The host's time."""
        return self.now_s

    def write(self, data: bytes, timeout_s: float) -> int:
        """Let the drive answer, unless this is lost."""
        del timeout_s
        for frame in data.split(b"\0")[:-1]:
            if frame:
                message = decode(frame, FROM_HOST)
                self.sent.append(message)
                if not self.loses_request(message):
                    self._answer(self.bench.drive.receive(frame + b"\0"))
        return len(data)

    def _answer(self, data: bytes) -> None:
        for frame in data.split(b"\0")[:-1]:
            for message in self.alters(decode(frame, FROM_DRIVE)):
                self._under_way.append((self.now_s + self.delay_s, encode(message)))

    def _arrive(self) -> None:
        while self._under_way and self._under_way[0][0] <= self.now_s:
            self._coming += self._under_way.popleft()[1]

    def read(self, timeout_s: float) -> bytes:
        """Give what has come, or let the time pass for both until something may."""
        self._arrive()
        if not self._coming:
            left_s = self.bench.drive.time_left_s
            waited_s = timeout_s if left_s is None else min(timeout_s, left_s + 1e-6)
            if self._under_way:
                waited_s = min(waited_s, self._under_way[0][0] - self.now_s)
            self.now_s += waited_s
            self.bench.clock.pass_us(waited_s * 1e6)
            self._answer(self.bench.drive.tick())
            self._arrive()
        data, self._coming = bytes(self._coming[:7]), self._coming[7:]
        return data

    def discard_input(self) -> None:
        """Forget what has come."""
        self._arrive()
        self._coming.clear()

    def close(self) -> None:
        """Note it."""
        self.closed = True

    def count(self, kind: type[HostMessage]) -> int:
        """How many of a kind were sent."""
        return Counter(map(type, self.sent))[kind]


def greeted(wire: Wire, limits: TimeLimits | None = None) -> Host:
    """A host of a session of ours."""
    return Host(wire, session=7, limits=limits, clock=wire.clock)


def running(wire: Wire, limits: TimeLimits | None = None) -> Host:
    """A host in a run, with a watchdog longer than its patience."""
    host = greeted(wire, limits)
    host.set("watchdog_us", 10_000_000)
    host.arm()
    host.start()
    return host


def step(host: Host) -> float:
    """A sample with the mechanics at rest off the reference."""
    return host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)
