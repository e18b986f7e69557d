"""A message to a frame and back, section 2 of `docs/protocol.md`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

import google_crc32c
from cobs import cobs

from lashloop.errors import LashloopError
from lashloop.layout import MAX_BODY, MAX_FRAME, OVERHEAD
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
    "MAX_BODY",
    "MAX_FRAME",
    "OVERHEAD",
    "BodyError",
    "CrcError",
    "Direction",
    "FrameError",
    "M",
    "MalformedError",
    "OversizedError",
    "crc32c",
    "decode",
    "encode",
    "open_frame",
]

M = TypeVar("M", bound=Message)


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


class Direction(Generic[M]):
    """One direction, with the messages of its sender."""

    def __init__(self, sender: str, messages: Iterable[type[M]]) -> None:
        """Index the messages by kind."""
        self.sender = sender
        self._layouts = {LAYOUTS[it].kind: LAYOUTS[it] for it in messages}

    def read_body(self, body: bytes) -> M:
        """Decode a body; `BodyError` if it isn't a message of this direction."""
        layout = self._layouts.get(body[0])
        if layout is None:
            raise BodyError(f"kind {body[0]:#04x} is not a message of the {self.sender}")
        lens = layout.body_lens
        if len(body) not in lens:
            allowed = str(lens[0]) if len(lens) == 1 else f"{lens[0]} to {lens[-1]} in steps of {lens[1] - lens[0]}"
            raise BodyError(f"a body of {len(body)} bytes, {layout.name} has {allowed}")
        try:
            message: M = layout.decode(body)
        except ValueError as error:
            raise BodyError(f"a field of {layout.name} holds no value of its type: {error}") from error
        return message


FROM_HOST: Direction[HostMessage] = Direction("host", HOST_MESSAGES)
FROM_DRIVE: Direction[DriveMessage] = Direction("drive", DRIVE_MESSAGES)


def crc32c(data: bytes) -> int:
    """Return the CRC-32/ISCSI."""
    checksum: int = google_crc32c.value(data)
    return checksum


def encode(message: Message) -> bytes:
    """Return the frame of a message, delimiter included; `FieldError` for a value outside its field's range."""
    body = LAYOUTS[type(message)].encode(message)
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


def decode(frame: bytes, direction: Direction[M]) -> M:
    """Decode one whole frame, with or without its delimiter; `FrameError` if it isn't a message."""
    return direction.read_body(open_frame(frame.removesuffix(DELIMITER)))
