"""Lines: what carries the bytes. POSIX only, as the bench itself.

A serial port is opened by pyserial; bytes then pass through its file descriptor, the same way as on a
pseudo-terminal.
"""

from __future__ import annotations

import os
import select
import time
import tty
from typing import TYPE_CHECKING, Protocol

import serial

from lashloop.errors import LashloopError

if TYPE_CHECKING:
    from collections.abc import Callable

DEFAULT_BAUD = 921_600
_AT_ONCE = 4096


class LineError(LashloopError):
    """The line can't be opened, or is gone."""


class Line(Protocol):
    """A stream of bytes both ways."""

    def read(self, timeout_s: float) -> bytes:
        """Give what has come, waiting for it at most this long; nothing if nothing came. `LineError` at its end."""

    def write(self, data: bytes, timeout_s: float) -> int:
        """Send what the line takes, waiting at most this long for room, and give how many bytes these were."""

    def discard_input(self) -> None:
        """Forget what has come and was not read."""

    def close(self) -> None:
        """Let go of it."""


class DescriptorLine:
    """A line over a file descriptor: a port, a pseudo-terminal, a socket, a pipe. It is set to not block."""

    def __init__(self, descriptor: int, name: str, close: Callable[[], None] | None = None) -> None:
        """Use an open descriptor. `close` is what ends it, by default closing the descriptor."""
        self.name = name
        self._descriptor = descriptor
        self._close = close or (lambda: os.close(descriptor))
        self._readable = _poll(descriptor, select.POLLIN)
        self._writable = _poll(descriptor, select.POLLOUT)
        os.set_blocking(descriptor, False)

    def read(self, timeout_s: float) -> bytes:
        """See `Line`."""
        if not self._readable.poll(_milliseconds(timeout_s)):
            return b""
        try:
            data = os.read(self._descriptor, _AT_ONCE)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise LineError(f"the line {self.name} is gone: {error.strerror}") from error
        if not data:
            # Readable with nothing to read: the far end has closed.
            raise LineError(f"the line {self.name} is gone: its far end has closed")
        return data

    def write(self, data: bytes, timeout_s: float) -> int:
        """See `Line`."""
        try:
            try:
                return os.write(self._descriptor, data)
            except BlockingIOError:
                events = self._writable.poll(_milliseconds(timeout_s))
                if not events:
                    return 0
                if events[0][1] & (select.POLLHUP | select.POLLERR):
                    # It would be told so again and again, with never any room.
                    raise LineError(f"the line {self.name} is gone: its far end has closed") from None
                return os.write(self._descriptor, data)
        except BlockingIOError:
            return 0
        except OSError as error:
            raise LineError(f"the line {self.name} is gone: {error.strerror}") from error

    def discard_input(self) -> None:
        """See `Line`."""
        while self.read(0.0):
            pass

    def close(self) -> None:
        """See `Line`."""
        self._close()


class PseudoTerminal(DescriptorLine):
    """The far end of a new pseudo-terminal in raw mode: where a drive sits. It stays up while no host is there."""

    def __init__(self) -> None:
        """Open one; `path` is where a host finds it."""
        try:
            far_end, near_end = os.openpty()
        except OSError as error:
            raise LineError(f"the system has no pseudo-terminal for the drive: {error.strerror}") from error
        tty.setraw(near_end)
        self.path = os.ttyname(near_end)

        def close() -> None:
            os.close(near_end)
            os.close(far_end)

        super().__init__(far_end, self.path, close)


def open_port(path: str, baud: int = DEFAULT_BAUD) -> DescriptorLine:
    """Open a serial port or the near end of a pseudo-terminal, raw, 8N1, and for nobody else."""
    try:
        port = serial.Serial(path, baud, exclusive=True)
    except (serial.SerialException, ValueError, OSError) as error:
        raise LineError(f"the port {path} can't be opened: {error}") from error
    return DescriptorLine(port.fileno(), path, port.close)


def send_all(line: Line, data: bytes, limit_s: float, clock: Callable[[], float] = time.monotonic) -> None:
    """Send all of it within this time; `LineError` if the far end does not take it."""
    deadline = clock() + limit_s
    rest = data
    while rest:
        left_s = max(deadline - clock(), 0.0)
        rest = rest[line.write(rest, left_s) :]
        if rest and left_s == 0.0:
            raise LineError(f"the far end took {len(data) - len(rest)} of {len(data)} bytes in {limit_s:g} s")


def _poll(descriptor: int, event: int) -> select.poll:
    poll = select.poll()
    poll.register(descriptor, event)
    return poll


def _milliseconds(timeout_s: float) -> float:
    # Rounded up: a wait that ends before its time would be another round for nothing.
    return max(int(timeout_s * 1e3 + 0.999), 0)
