"""From a stream of bytes to messages, in pieces of any size, with anything in between."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Generic

from lashloop.frames import (
    MAX_FRAME,
    CrcError,
    Direction,
    FrameError,
    M,
    MalformedError,
    OversizedError,
    open_frame,
)

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(slots=True)
class Counters:
    """What a decoder has seen."""

    messages: int = 0
    """Good messages."""
    discarded_bytes: int = 0
    """Bytes thrown away with bad frames, their delimiters included."""
    oversized: int = 0
    """Frames longer than a frame can be."""
    malformed: int = 0
    """Frames with broken stuffing or too short for a CRC."""
    crc_errors: int = 0
    """Frames whose CRC was wrong."""
    refused: int = 0
    """Whole frames that were no message of this direction and version."""

    @property
    def damaged(self) -> int:
        """Frames that arrived damaged, in whatever way."""
        return self.oversized + self.malformed + self.crc_errors


class Decoder(Generic[M]):
    """The incremental decoder of one direction. It keeps at most one frame."""

    def __init__(self, direction: Direction[M]) -> None:
        """Begin at the start of a frame."""
        self._direction = direction
        self._partial = b""
        self._dropped = 0
        self._counters = Counters()

    @property
    def counters(self) -> Counters:
        """What has been seen up to the item that was given last."""
        return replace(self._counters)

    def feed(self, data: bytes) -> Iterator[M | FrameError]:
        """Give the messages and bad frames that end in `data`, in order. Use the iterator up before the next call.

        Delimiters without anything between them are no frames: they are how a sender clears the line.
        """
        *ended, rest = data.split(b"\0")
        for piece in ended:
            self._append(piece)
            if self._partial:
                yield self._close()
        self._append(rest)

    def _append(self, piece: bytes) -> None:
        # Beyond the longest frame bytes are only counted.
        room = MAX_FRAME - len(self._partial)
        self._partial += piece[:room]
        self._dropped += max(len(piece) - room, 0)

    def _close(self) -> M | FrameError:
        stuffed, dropped = self._partial, self._dropped
        self._partial, self._dropped = b"", 0
        try:
            if dropped:
                raise OversizedError(len(stuffed) + dropped)
            message = self._direction.read_body(open_frame(stuffed))
        except FrameError as error:
            self._count(error, len(stuffed) + dropped + 1)
            return error
        self._counters.messages += 1
        return message

    def _count(self, error: FrameError, length: int) -> None:
        counters = self._counters
        counters.discarded_bytes += length
        if isinstance(error, OversizedError):
            counters.oversized += 1
        elif isinstance(error, MalformedError):
            counters.malformed += 1
        elif isinstance(error, CrcError):
            counters.crc_errors += 1
        else:
            counters.refused += 1
