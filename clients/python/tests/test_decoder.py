"""The decoder handles splits, noise and damage, and counts them."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from lashloop.decoder import Counters, Decoder
from lashloop.enums import ParameterValue
from lashloop.frames import FROM_HOST, FrameError, Numbered, encode
from lashloop.layout import has_number
from lashloop.messages import Arm, EncoderSample, GetParameter, HostMessage, LineReport, SetParameter, Stop
from support import sealed

SESSIONS = st.integers(0, 2**32 - 1)
SEQUENCES = st.integers(0, 2**16 - 1)
COUNTS = st.integers(-(2**23), 2**23 - 1)
REALS = st.floats(width=32, allow_nan=False)
NUMBERS = st.integers(0, 255)
MESSAGES: st.SearchStrategy[HostMessage] = st.one_of(
    st.builds(Arm, SESSIONS),
    st.builds(GetParameter, st.integers(0, 255)),
    st.builds(EncoderSample, SEQUENCES, COUNTS, COUNTS, REALS),
    st.builds(SetParameter, st.integers(0, 255), st.builds(ParameterValue.f32, REALS)),
    st.just(Stop()),
)


def numbered(pieces: list[bytes]) -> tuple[list[Numbered[HostMessage]], Counters]:
    """The messages of a stream in pieces with their numbers, and the counters."""
    decoder = Decoder(FROM_HOST)
    items = [item for piece in pieces for item in decoder.feed(piece)]
    return [item for item in items if isinstance(item, Numbered)], decoder.counters


def decoded(pieces: list[bytes]) -> tuple[list[HostMessage], Counters]:
    """The messages of a stream in pieces, and the counters."""
    items, counters = numbered(pieces)
    return [item.message for item in items], counters


def split(data: bytes, places: list[int]) -> list[bytes]:
    """A stream divided at these places."""
    cuts = [0, *sorted(place % (len(data) + 1) for place in places), len(data)]
    return [data[start:end] for start, end in pairwise(cuts)]


@given(st.lists(st.tuples(MESSAGES, NUMBERS)), st.lists(st.integers(0, 10**6)))
def test_messages_are_decoded_from_any_pieces(sent: list[tuple[HostMessage, int]], places: list[int]) -> None:
    stream = b"".join(encode(message, number) for message, number in sent)
    items = [Numbered(number if has_number(message.KIND) else 0, message) for message, number in sent]
    assert numbered(split(stream, places)) == (items, Counters(messages=len(sent)))


@given(st.binary(), MESSAGES, st.lists(st.integers(0, 10**6)))
def test_noise_before_a_delimiter_has_no_effect_after_it(noise: bytes, message: HostMessage, places: list[int]) -> None:
    messages, counters = decoded(split(noise + b"\0" + encode(message), places))
    assert messages[-1] == message
    # Every byte belongs to a good frame, to a bad frame, or is an idle delimiter.
    alone = sum(not piece for piece in (noise + b"\0").split(b"\0")[:-1])
    good = sum(len(encode(it)) for it in messages[:-1])
    assert counters.discarded_bytes + alone + good == len(noise) + 1


@given(MESSAGES, st.integers(0, 10**6))
def test_a_frame_with_a_flipped_bit_is_no_message(message: HostMessage, place: int) -> None:
    frame = bytearray(encode(message))
    bit = place % (8 * (len(frame) - 1))
    frame[bit // 8] ^= 1 << bit % 8
    messages, counters = decoded([bytes(frame), encode(Stop())])
    assert messages == [Stop()]
    assert counters.refused == 0
    assert counters.damaged + frame[:-1].count(0) >= 1


def test_every_kind_of_damage_has_a_counter() -> None:
    whole = encode(GetParameter(3))
    bad_crc = whole[:-2] + bytes([whole[-2] ^ 2]) + b"\0"
    stream = [
        bad_crc,
        whole[:4] + b"\0",
        b"\x01\0",
        b"\x55" * 64 + b"\0",
        b"\x55" * 1000 + b"\0",
        encode(LineReport(0, 0, 0, 0)),
        sealed(b"\x7f\x01"),
        b"\0\0\0",
        whole,
    ]
    messages, counters = decoded(stream)
    assert messages == [GetParameter(3)]
    assert counters == Counters(
        messages=1,
        discarded_bytes=sum(map(len, stream[:6])),
        oversized=2,
        malformed=2,
        crc_errors=1,
        refused=1,
        unknown=1,
    )


def test_the_longest_frame_has_64_bytes() -> None:
    # 63 bytes before the delimiter are a whole frame, of an unknown kind; 64 exceed a frame.
    for length, wanted in (
        (58, Counters(unknown=1)),
        (59, Counters(oversized=1, discarded_bytes=65)),
    ):
        assert decoded([sealed(b"\x7f" * length)]) == ([], wanted)


def test_counters_include_the_last_item_returned() -> None:
    decoder = Decoder(FROM_HOST)
    seen = [decoder.counters.messages for _ in decoder.feed(encode(Stop()) * 3)]
    assert seen == [1, 2, 3]


def test_endless_noise_needs_no_memory() -> None:
    decoder = Decoder(FROM_HOST)
    for _ in range(1000):
        assert list(decoder.feed(b"\x55" * 1000)) == []
    (error,) = decoder.feed(b"\0")
    assert isinstance(error, FrameError)
    assert "1000000 bytes without a delimiter" in str(error)
    assert decoder.counters == Counters(oversized=1, discarded_bytes=1_000_001)
