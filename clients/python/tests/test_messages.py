"""Messages and frames agree with the golden frames and with the specification."""

from __future__ import annotations

import json
from typing import Any

import pytest
from cobs import cobs

from lashloop import frames, messages
from lashloop.drive.description import MOST_LAWS, MOST_SIGNALS
from lashloop.enums import (
    FaultCode,
    LogLevel,
    Outcome,
    ParameterFlags,
    ParameterType,
    ParameterValue,
    State,
    TorqueFlags,
    TorqueStatus,
    Version,
    WireEnum,
    shortest,
    single,
)
from lashloop.errors import FieldError
from lashloop.frames import FROM_DRIVE, FROM_HOST, BodyError, CrcError, MalformedError, OversizedError
from lashloop.layout import MAX_TELEMETRY_VALUES
from lashloop.messages import DRIVE_MESSAGES, HOST_MESSAGES, LAYOUTS, Log, Message
from support import WORKSPACE, document, table

GOLDEN = json.loads((WORKSPACE / "protocol/golden/v1.json").read_text())
ALL: tuple[type[Message], ...] = (*HOST_MESSAGES, *DRIVE_MESSAGES)
LISTS: dict[str, type[WireEnum]] = {"state": State, "outcome": Outcome, "code": FaultCode, "level": LogLevel}


def direction(kind: int) -> Any:
    return FROM_HOST if kind < 0x80 else FROM_DRIVE


def from_json(name: str, value: Any, flags: type[TorqueFlags | ParameterFlags] = ParameterFlags) -> Any:
    """A field of the golden file, converted to the value of the message."""
    if name == "status":
        return TorqueStatus(**{part: from_json(part, it, TorqueFlags) for part, it in value.items()})
    if name == "values":
        return tuple(map(single, value))
    if isinstance(value, dict):
        make = ParameterValue.f32 if value["type"] == "F32" else ParameterValue.u32
        return make(value["value"])
    if name == "flags":
        return flags(sum(flags[flag] for flag in value))
    if name == "firmware":
        return Version(*map(int, value.split(".")))
    if name in LISTS:
        return next(it for it in LISTS[name] if it.label == value)
    return single(value) if isinstance(value, float) else value


@pytest.mark.parametrize("golden", GOLDEN["frames"], ids=lambda it: str(it["name"]))
def test_golden_frames_decode_and_encode_to_the_same_bytes(golden: dict[str, Any]) -> None:
    frame = bytes.fromhex(golden["frame"])
    message_type = getattr(messages, golden["name"])
    fields = {name: from_json(name, value) for name, value in golden["fields"].items()}
    assert frames.decode(frame, direction(golden["kind"])) == message_type(**fields)
    assert frames.encode(message_type(**fields)) == frame


def test_the_golden_file_has_every_message() -> None:
    assert GOLDEN["protocol_version"] == messages.PROTOCOL_VERSION
    assert [it["name"] for it in GOLDEN["frames"]] == [it.__name__ for it in ALL]


def test_kinds_senders_and_lengths_are_those_of_the_specification() -> None:
    rows = {row[1]: (row[0], row[2], row[3]) for row in table("## 4. Messages")}
    ours = {
        it.__name__: (
            f"{it.KIND:#04x}",
            "host" if it in HOST_MESSAGES else "drive",
            " to ".join(str(end + frames.OVERHEAD) for end in ends(LAYOUTS[it].body_lens)),
        )
        for it in ALL
    }
    assert ours == rows


def ends(lens: list[int]) -> list[int]:
    """The smallest and the largest number, or the only one."""
    return sorted({lens[0], lens[-1]})


@pytest.mark.parametrize("message", ALL, ids=lambda it: str(it.__name__))
def test_layouts_are_those_of_the_specification(message: type[Message]) -> None:
    layout = LAYOUTS[message]
    rows = table(f"### {layout.name} ({layout.kind:#04x})")
    ours = [(str(field.offset), field.name, field.wire.name) for field in layout.fields]
    assert ours == [(row[0], row[2], row[3]) for row in rows]


@pytest.mark.parametrize(
    "values",
    [State, FaultCode, Outcome, LogLevel, ParameterType],
)
def test_lists_are_those_of_the_specification(values: type[WireEnum]) -> None:
    rows = [(int(row[0]), row[1]) for row in table(f"### {values.__name__}")]
    assert [(int(it), it.label) for it in values] == rows


@pytest.mark.parametrize("flags", [TorqueFlags, ParameterFlags])
def test_flags_are_those_of_the_specification(flags: type[TorqueFlags | ParameterFlags]) -> None:
    rows = [(int(row[0], 16), row[1]) for row in table(f"### {flags.__name__}")]
    assert [(it.value, it.name) for it in flags] == rows


def test_the_crc_has_the_check_value_and_residue_of_the_specification() -> None:
    rows = dict(row[:2] for row in table("### CRC"))
    checksum = frames.crc32c(b"123456789")
    assert checksum == int(rows["check value"], 16)
    # The residue is the register after a body with its CRC, before the final xor.
    with_crc = frames.crc32c(b"123456789" + checksum.to_bytes(4, "little"))
    assert with_crc ^ 0xFFFFFFFF == int(rows["residue"], 16)


def test_limits_are_those_of_the_specification() -> None:
    rows = {row[0]: int(row[1]) for row in table("## 2. Frames")}
    ours = {
        "PROTOCOL_VERSION": messages.PROTOCOL_VERSION,
        "MAX_FRAME": frames.MAX_FRAME,
        "MAX_BODY": frames.MAX_BODY,
        "OVERHEAD": frames.OVERHEAD,
        "DELIMITER": frames.DELIMITER[0],
        "MAX_LAWS": MOST_LAWS,
        "MAX_SIGNALS": MOST_SIGNALS,
        "MAX_TELEMETRY_VALUES": MAX_TELEMETRY_VALUES,
    }
    assert ours == rows
    assert max(max(LAYOUTS[it].body_lens) for it in ALL) <= frames.MAX_BODY


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (messages.Arm(2**32), "Arm.session is 4294967296, allowed is 0 to 4294967295"),
        (messages.Arm(-1), "Arm.session is -1, allowed is 0 to 4294967295"),
        (messages.EncoderSample(0, 2**23, 0, 0.0), "EncoderSample.motor_counts is 8388608, allowed is -8388608 to"),
        (messages.EncoderSample(2**16, 0, 0, 0.0), "EncoderSample.sequence is 65536, allowed is 0 to 65535"),
        (messages.EncoderSample(0, 0, 0, 1e39), "EncoderSample.reference_rad is 1e+39, allowed is"),
        (messages.SetParameter(256, ParameterValue.u32(0)), "SetParameter.index is 256, allowed is 0 to 255"),
        (messages.SetParameter(0, ParameterValue.u32(-1)), "SetParameter.value is"),
        (messages.Telemetry(0, ()), "Telemetry.values is (), allowed is 1 to 13 numbers of type f32"),
        (messages.Telemetry(0, (0.0,) * 14), "Telemetry.values is (0.0, "),
        (messages.Telemetry(0, (0.0, 1e39)), "Telemetry.values is (0.0, 1e+39), allowed is"),
        (Log(LogLevel.INFO, "x" * 53), "Log.text is"),
        (Log(LogLevel.INFO, "a\0b"), "Log.text is"),
    ],
)
def test_a_value_outside_its_field_is_named_with_the_range(message: Message, expected: str) -> None:
    with pytest.raises(FieldError) as raised:
        frames.encode(message)
    assert str(raised.value).startswith(expected)


def sealed(body: bytes) -> bytes:
    """A frame around any body."""
    stuffed: bytes = cobs.encode(body + frames.crc32c(body).to_bytes(4, "little"))
    return stuffed + b"\0"


@pytest.mark.parametrize(
    "body",
    [
        b"\x00",
        b"\x7f",
        b"\x81",
        b"\x05\0\0\0",
        b"\x05\0\0\0\0\0",
        b"\x04\0\x03\0\0\0\0",
        b"\x04\0\x00\0\0\0\0",
    ],
    ids=["kind 0", "unknown kind", "other direction", "too short", "too long", "value of type 3", "value of type 0"],
)
def test_a_whole_frame_that_is_no_message_is_rejected(body: bytes) -> None:
    with pytest.raises(BodyError):
        frames.decode(sealed(body), FROM_HOST)


@pytest.mark.parametrize(
    "body",
    [
        b"\x85\x06\x0c\x01",
        b"\x85\x06\x00\x01",
        b"\x85\x06\x01\x06",
        b"\x90" + bytes(6) + b"\x84\0\0",
        b"\x90" + bytes(6) + b"\x06\0\0",
        b"\x90" + bytes(6) + b"\x10\0\0",
        b"\x93\x05" + bytes(52),
        b"\x93\x01a\0b" + bytes(49),
        b"\x93\x01\xff" + bytes(51),
    ],
    ids=[
        "outcome",
        "outcome 0",
        "state",
        "torque flag",
        "torque state",
        "torque state 0",
        "level",
        "text after its end",
        "not UTF-8",
    ],
)
def test_a_field_with_an_invalid_value_is_rejected(body: bytes) -> None:
    with pytest.raises(BodyError):
        frames.decode(sealed(body), FROM_DRIVE)


def test_parameter_flags_without_a_name_are_kept() -> None:
    golden = next(it for it in GOLDEN["frames"] if it["name"] == "ParameterDescription")
    body = bytearray(frames.open_frame(bytes.fromhex(golden["frame"])[:-1]))
    body[2] = 0x81
    description = frames.decode(sealed(bytes(body)), FROM_DRIVE)
    assert isinstance(description, messages.ParameterDescription)
    assert ParameterFlags.LIVE in description.flags
    assert ParameterFlags.CHOICES not in description.flags
    assert frames.encode(description) == sealed(bytes(body))


def test_telemetry_has_1_to_13_values_and_no_other_length() -> None:
    for length in range(64):
        body = b"\x91\x07\x00" + b"\x40" * length
        whole = length % 4 == 0 and 4 <= length <= 52
        if whole:
            telemetry = frames.decode(sealed(body), FROM_DRIVE)
            assert telemetry == messages.Telemetry(7, (single(3.0039215),) * (length // 4))
            assert frames.encode(telemetry) == sealed(body)
        elif len(sealed(body)) <= frames.MAX_FRAME:
            with pytest.raises(BodyError, match=f"a body of {3 + length} bytes, Telemetry has 7 to 55 in steps of 4"):
                frames.decode(sealed(body), FROM_DRIVE)


def test_telemetry_of_six_signals_takes_33_bytes() -> None:
    assert len(frames.encode(messages.Telemetry(0, (1.0,) * 6))) == 33


def test_kinds_of_damage_are_distinguished() -> None:
    whole = frames.encode(messages.Stop())
    with pytest.raises(CrcError):
        frames.decode(whole[:2] + bytes([whole[2] ^ 1]) + whole[3:], FROM_HOST)
    with pytest.raises(MalformedError):
        frames.decode(whole[:3], FROM_HOST)
    with pytest.raises(MalformedError):
        frames.decode(b"\x01\0", FROM_HOST)
    with pytest.raises(OversizedError):
        frames.decode(b"\x01" * 64 + b"\0", FROM_HOST)


def test_frames_of_the_specification_decode_and_encode_again() -> None:
    shown = [bytes.fromhex(line[7:]) for line in document().splitlines() if line.startswith("frame: ")]
    assert len(shown) > 16
    for frame in shown:
        kind = frames.open_frame(frame[:-1])[0]
        assert frames.encode(frames.decode(frame, direction(kind))) == frame


def test_numbers_have_the_fewest_digits_that_read_back() -> None:
    for text in ["0.1", "0.333333", "0.3333333", "1000000", "-20.5", "0.000972", "1e-09", "nan", "inf", "0"]:
        assert shortest(single(float(text))) == text
