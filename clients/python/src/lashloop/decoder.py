"""A stream of bytes, in pieces of any size, to messages."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Generic

from lashloop.frames import (
    CrcError,
    Direction,
    FrameError,
    M,
    MalformedError,
    Numbered,
    OversizedError,
    UnknownKindError,
    open_frame,
)
from lashloop.limits import MAX_FRAME

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(slots=True)
class Counters:
    """Statistics of a decoder."""

    messages: int = 0
    """Messages decoded."""
    discarded_bytes: int = 0
    """Bytes of rejected frames, delimiters included."""
    oversized: int = 0
    """Frames longer than `MAX_FRAME`."""
    malformed: int = 0
    """Frames with invalid stuffing, or too short for a CRC."""
    crc_errors: int = 0
    """Frames with a wrong CRC."""
    refused: int = 0
    """Whole frames that aren't messages of this direction and version."""
    unknown: int = 0
    """Whole frames of a kind that a newer peer has added."""

    @property
    def damaged(self) -> int:
        """Damaged frames: oversized, malformed, or with a wrong CRC."""
        return self.oversized + self.malformed + self.crc_errors


class Decoder(Generic[M]):
    """The incremental decoder of one direction. It buffers at most one frame."""

    def __init__(self, direction: Direction[M]) -> None:
        """Begin at the start of a frame."""
        self._direction = direction
        self._partial = b""
        self._dropped = 0
        self._counters = Counters()

    @property
    def counters(self) -> Counters:
        """Statistics up to the last item returned."""
        return replace(self._counters)

    def feed(self, data: bytes) -> Iterator[Numbered[M] | FrameError]:
        """Yield the messages and bad frames that end in `data`. Exhaust the iterator before the next call.

        Consecutive delimiters are not frames: a sender clears the line with them.
        """
        *ended, rest = data.split(b"\0")
        for piece in ended:
            self._append(piece)
            if self._partial:
                yield self._close()
        self._append(rest)

    def _append(self, piece: bytes) -> None:
        # Bytes beyond the longest frame are counted but not kept.
        free = MAX_FRAME - len(self._partial)
        self._partial += piece[:free]
        self._dropped += max(len(piece) - free, 0)

    def _close(self) -> Numbered[M] | FrameError:
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
        if isinstance(error, UnknownKindError):
            counters.unknown += 1
            return
        counters.discarded_bytes += length
        if isinstance(error, OversizedError):
            counters.oversized += 1
        elif isinstance(error, MalformedError):
            counters.malformed += 1
        elif isinstance(error, CrcError):
            counters.crc_errors += 1
        else:
            counters.refused += 1
