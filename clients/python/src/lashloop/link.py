"""Links: carriers of bytes in both directions. POSIX only, as is the bench.

Pyserial opens a serial port; bytes then pass through its file descriptor, as on a pseudo-terminal.
"""

from __future__ import annotations

import os
import select
import sys
import time
import tty
from typing import TYPE_CHECKING, Protocol

import serial

from lashloop.errors import LashloopError

if TYPE_CHECKING:
    from collections.abc import Callable

DEFAULT_BAUD = 921_600
_AT_ONCE = 4096


class LinkError(LashloopError):
    """The link can't be opened, or has failed."""


class LinkClosedError(LinkError):
    """The far end has closed the link in order."""


class Link(Protocol):
    """A stream of bytes in both directions."""

    def read(self, timeout_s: float) -> bytes:
        """Return received bytes, or none after the timeout. `LinkError` if the link has failed."""

    def write(self, data: bytes, timeout_s: float) -> int:
        """Send as many bytes as the link accepts within the timeout and return their number."""

    def discard_input(self) -> None:
        """Discard received bytes that were not read."""

    def close(self) -> None:
        """Close the link."""


class DescriptorLink:
    """A link over a file descriptor (port, pseudo-terminal, socket, pipe), set to non-blocking."""

    def __init__(self, descriptor: int, name: str, close: Callable[[], None] | None = None) -> None:
        """Use an open descriptor. `close` replaces closing the descriptor."""
        self.name = name
        self._descriptor = descriptor
        self._close = close or (lambda: os.close(descriptor))
        self._readable = _poll(descriptor, select.POLLIN)
        self._writable = _poll(descriptor, select.POLLOUT)
        os.set_blocking(descriptor, False)

    def read(self, timeout_s: float) -> bytes:
        """See `Link`."""
        if not self._readable.poll(_milliseconds(timeout_s)):
            return b""
        try:
            data = os.read(self._descriptor, _AT_ONCE)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise LinkError(f"the link {self.name} has failed: {error.strerror}") from error
        if not data:
            # Readable without data: the far end has closed.
            raise LinkClosedError(f"the link {self.name} has failed: its far end has closed")
        return data

    def write(self, data: bytes, timeout_s: float) -> int:
        """See `Link`."""
        try:
            try:
                return os.write(self._descriptor, data)
            except BlockingIOError:
                events = self._writable.poll(_milliseconds(timeout_s))
                if not events:
                    return 0
                if events[0][1] & (select.POLLHUP | select.POLLERR):
                    # Poll would report the hang-up forever, without buffer space.
                    raise LinkError(f"the link {self.name} has failed: its far end has closed") from None
                return os.write(self._descriptor, data)
        except BlockingIOError:
            return 0
        except BrokenPipeError as error:
            raise LinkClosedError(f"the link {self.name} has failed: its far end has closed") from error
        except OSError as error:
            raise LinkError(f"the link {self.name} has failed: {error.strerror}") from error

    def discard_input(self) -> None:
        """See `Link`."""
        while self.read(0.0):
            pass

    def close(self) -> None:
        """See `Link`."""
        self._close()


class PseudoTerminal(DescriptorLink):
    """The drive's end of a new pseudo-terminal in raw mode. It stays open without a host."""

    def __init__(self) -> None:
        """Open the pseudo-terminal; `path` is its end for the host."""
        try:
            far_end, near_end = os.openpty()
        except OSError as error:
            raise LinkError(f"the system has no pseudo-terminal for the drive: {error.strerror}") from error
        tty.setraw(near_end)
        self.path = os.ttyname(near_end)
        # The drive's own handle of the host's end keeps the terminal open between two hosts.
        self._near_end: int | None = near_end
        super().__init__(far_end, self.path)

    def hang_up(self) -> None:
        """Close the host's end: once no host has it open, `read` fails with `LinkError`, in another thread too."""
        if self._near_end is not None:
            os.close(self._near_end)
            self._near_end = None

    def close(self) -> None:
        """See `Link`."""
        self.hang_up()
        super().close()


class StandardStreams:
    """Standard input and output as a link, for a drive that the bench starts: `--device "exec:python drive.py"`.

    What the program prints from then on goes to standard error, because it would be noise on the link.
    """

    def __init__(self) -> None:
        """Take the streams."""
        sys.stdout.flush()
        output = os.dup(sys.stdout.fileno())
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        self._input = DescriptorLink(sys.stdin.fileno(), "on standard input")
        self._output = DescriptorLink(output, "on standard output")

    def read(self, timeout_s: float) -> bytes:
        """See `Link`."""
        return self._input.read(timeout_s)

    def write(self, data: bytes, timeout_s: float) -> int:
        """See `Link`."""
        return self._output.write(data, timeout_s)

    def discard_input(self) -> None:
        """See `Link`."""
        self._input.discard_input()

    def close(self) -> None:
        """See `Link`."""
        self._input.close()
        self._output.close()


def open_port(path: str, baud: int = DEFAULT_BAUD) -> DescriptorLink:
    """Open a serial port or the host's end of a pseudo-terminal, raw, 8N1, exclusive."""
    try:
        port = serial.Serial(path, baud, exclusive=True)
    except (serial.SerialException, ValueError, OSError) as error:
        raise LinkError(f"the port {path} can't be opened: {error}") from error
    return DescriptorLink(port.fileno(), path, port.close)


def send_all(link: Link, data: bytes, limit_s: float, clock: Callable[[], float] = time.monotonic) -> None:
    """Send all bytes within this time; `LinkError` if the far end does not accept them."""
    deadline = clock() + limit_s
    rest = data
    while rest:
        left_s = max(deadline - clock(), 0.0)
        rest = rest[link.write(rest, left_s) :]
        if rest and left_s == 0.0:
            raise LinkError(f"the far end accepted {len(data) - len(rest)} of {len(data)} bytes in {limit_s:g} s")


def _poll(descriptor: int, event: int) -> select.poll:
    poll = select.poll()
    poll.register(descriptor, event)
    return poll


def _milliseconds(timeout_s: float) -> float:
    # Rounded up: a wait that ends early would repeat the loop without effect.
    return max(int(timeout_s * 1e3 + 0.999), 0)
