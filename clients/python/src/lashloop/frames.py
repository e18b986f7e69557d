"""A message to a frame and back, section 2 of `docs/protocol.md`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

import google_crc32c
from cobs import cobs

from lashloop.errors import LashloopError
from lashloop.layout import has_number
from lashloop.limits import MAX_FRAME, MINOR_VERSION, PROTOCOL_VERSION
from lashloop.messages import DRIVE_MESSAGES, HOST_MESSAGES, LAYOUTS, DriveMessage, HostMessage, Message

if TYPE_CHECKING:
    from collections.abc import Iterable

DELIMITER = b"\0"
"""Ends every frame and occurs nowhere else."""
_CRC_LEN = 4

__all__ = [
    "DELIMITER",
    "FROM_DRIVE",
    "FROM_HOST",
    "BodyError",
    "CrcError",
    "Direction",
    "FrameError",
    "M",
    "MalformedError",
    "Numbered",
    "OversizedError",
    "UnknownKindError",
    "crc32c",
    "decode",
    "encode",
    "open_frame",
]

M = TypeVar("M", bound=Message)


@dataclass(frozen=True, slots=True)
class Numbered(Generic[M]):
    """A message, and the number of the request that it is or answers."""

    number: int
    """1 to 255 as the host chose it, 0 for none; 0 of every kind without a number."""
    message: M


class FrameError(LashloopError):
    """The bytes between two delimiters aren't a message. They are discarded whole."""


class OversizedError(FrameError):
    """No delimiter within the longest frame."""

    def __init__(self, length: int) -> None:
        """Name the number of bytes, without the delimiter."""
        super().__init__(f"{length} bytes without a delimiter, a frame has at most {MAX_FRAME} with it")


class MalformedError(FrameError):
    """The stuffing is invalid, or the frame is too short for a kind and a CRC."""


class CrcError(FrameError):
    """The CRC over the body differs from the CRC in the frame."""


class BodyError(FrameError):
    """The frame is whole but isn't a message of this version and direction."""


class UnknownKindError(BodyError):
    """The frame is whole and of a kind that a newer peer has added. It is skipped, and not refused."""

    def __init__(self, kind: int, number: int) -> None:
        """Name the kind; the number is that of the request or answer, 0 if the body has none."""
        super().__init__(f"kind {kind:#04x} is not known to protocol version {PROTOCOL_VERSION}.{MINOR_VERSION}")
        self.kind, self.number = kind, number


class Direction(Generic[M]):
    """One direction, with the messages of its sender."""

    def __init__(self, sender: str, messages: Iterable[type[M]], kinds: range) -> None:
        """Index the messages by kind; the sender's messages of any version have these kinds."""
        self.sender = sender
        self._layouts = {LAYOUTS[it].kind: LAYOUTS[it] for it in messages}
        self._kinds = kinds

    def read_body(self, body: bytes) -> Numbered[M]:
        """Decode a body; `BodyError` if it isn't a message of this direction."""
        kind = body[0]
        number = body[1] if has_number(kind) and len(body) > 1 else 0
        layout = self._layouts.get(kind)
        if layout is None:
            if kind in self._kinds:
                raise UnknownKindError(kind, number)
            raise BodyError(f"kind {kind:#04x} is not a kind of the {self.sender}")
        if not layout.takes(len(body)):
            shortest, *more = layout.body_lens
            steps = f"{shortest} to {more[-1]} in steps of {more[0] - shortest}" if len(body) >= shortest else ""
            raise BodyError(f"a body of {len(body)} bytes, {layout.name} has {steps or f'at least {shortest}'}")
        try:
            return Numbered(number, layout.decode(body))
        except ValueError as error:
            raise BodyError(f"a field of {layout.name} holds no value of its type: {error}") from error


FROM_HOST: Direction[HostMessage] = Direction("host", HOST_MESSAGES, range(0x01, 0x80))
FROM_DRIVE: Direction[DriveMessage] = Direction("drive", DRIVE_MESSAGES, range(0x81, 0x100))


def crc32c(data: bytes) -> int:
    """Return the CRC-32/ISCSI."""
    checksum: int = google_crc32c.value(data)
    return checksum


def encode(message: Message, number: int = 0) -> bytes:
    """Return the frame of a message, delimiter included; `FieldError` for a value outside its field's range.

    `number` is that of the request, or of the request that the message answers; kinds without a number ignore it.
    """
    body = LAYOUTS[type(message)].encode(message, number)
    stuffed: bytes = cobs.encode(body + crc32c(body).to_bytes(_CRC_LEN, "little"))
    return stuffed + DELIMITER


def open_frame(stuffed: bytes) -> bytes:
    """Return the body in the bytes between two delimiters; `FrameError` if they aren't a frame."""
    if len(stuffed) >= MAX_FRAME:
        raise OversizedError(len(stuffed))
    try:
        unstuffed: bytes = cobs.decode(stuffed)
    except cobs.DecodeError:
        raise MalformedError(f"a frame of {len(stuffed)} bytes is not valid COBS") from None
    body, found = unstuffed[:-_CRC_LEN], int.from_bytes(unstuffed[-_CRC_LEN:], "little")
    if not body:
        raise MalformedError(f"a frame of {len(stuffed)} bytes is too short for a kind and a CRC")
    expected = crc32c(body)
    if found != expected:
        raise CrcError(f"CRC {found:#010x} in the frame, {expected:#010x} over its body")
    return body


def decode(frame: bytes, direction: Direction[M]) -> Numbered[M]:
    """Decode one whole frame, with or without its delimiter; `FrameError` if it isn't a message."""
    return direction.read_body(open_frame(frame.removesuffix(DELIMITER)))
