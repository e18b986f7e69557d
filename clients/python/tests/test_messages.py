"""Messages and frames agree with the golden frames and with the specification."""

from __future__ import annotations

import copy
import json
import pickle
from dataclasses import replace
from typing import Any

import pytest

from lashloop import frames, limits, messages
from lashloop.enums import (
    Capabilities,
    CaptureTrigger,
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
    ZeroSource,
    shortest,
    single,
)
from lashloop.errors import FieldError
from lashloop.frames import (
    FROM_DRIVE,
    FROM_HOST,
    BodyError,
    CrcError,
    MalformedError,
    Numbered,
    OversizedError,
    UnknownKindError,
)
from lashloop.messages import DRIVE_MESSAGES, HOST_MESSAGES, LAYOUTS, Log, Message
from support import WORKSPACE, document, sealed, table

GOLDEN = json.loads((WORKSPACE / "protocol/golden/v1.json").read_text())
ALL: tuple[type[Message], ...] = (*HOST_MESSAGES, *DRIVE_MESSAGES)
LISTS: dict[str, type[WireEnum]] = {
    "state": State,
    "outcome": Outcome,
    "code": FaultCode,
    "level": LogLevel,
    "source": ZeroSource,
    "trigger": CaptureTrigger,
}


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
    if name == "capabilities":
        return Capabilities(sum(Capabilities[flag] for flag in value))
    if name == "firmware":
        return Version(*map(int, value.split(".")))
    if name in LISTS and isinstance(value, str):
        return next(it for it in LISTS[name] if it.label == value)
    return single(value) if isinstance(value, float) else value


@pytest.mark.parametrize("golden", GOLDEN["frames"], ids=lambda it: str(it["name"]))
def test_golden_frames_decode_and_encode_to_the_same_bytes(golden: dict[str, Any]) -> None:
    frame = bytes.fromhex(golden["frame"])
    message_type = getattr(messages, golden["name"])
    fields = {name: from_json(name, value) for name, value in golden["fields"].items()}
    number = golden.get("number", 0)
    assert frames.decode(frame, direction(golden["kind"])) == Numbered(number, message_type(**fields))
    assert frames.encode(message_type(**fields), number) == frame


def test_the_golden_file_has_every_message() -> None:
    assert GOLDEN["protocol_version"] == limits.PROTOCOL_VERSION
    assert [it["name"] for it in GOLDEN["frames"]] == [it.__name__ for it in ALL]


def test_kinds_senders_and_lengths_are_those_of_the_specification() -> None:
    rows = {row[1]: (row[0], row[2], row[3]) for row in table("## 4. Messages")}
    ours = {
        it.__name__: (
            f"{it.KIND:#04x}",
            "host" if it in HOST_MESSAGES else "drive",
            " to ".join(str(end + limits.OVERHEAD) for end in ends(LAYOUTS[it].body_lens)),
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
    # A message without fields may have no table.
    rows = table(f"### {layout.name} ({layout.kind:#04x})") if layout.fields else []
    ours = [(str(it.offset), it.name, it.wire.name, it.wire.optional) for it in layout.fields]
    assert ours == [(row[0], row[2], row[3], "optional" in row[4]) for row in rows]


@pytest.mark.parametrize(
    "values",
    [State, FaultCode, Outcome, LogLevel, ParameterType, ZeroSource, CaptureTrigger],
)
def test_lists_are_those_of_the_specification(values: type[WireEnum]) -> None:
    rows = [(int(row[0]), row[1]) for row in table(f"### {values.__name__}")]
    assert [(int(it), it.label) for it in values] == rows


@pytest.mark.parametrize("flags", [TorqueFlags, ParameterFlags, Capabilities])
def test_flags_are_those_of_the_specification(flags: type[TorqueFlags | ParameterFlags | Capabilities]) -> None:
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
        "PROTOCOL_VERSION": limits.PROTOCOL_VERSION,
        "MINOR_VERSION": limits.MINOR_VERSION,
        "MAX_FRAME": limits.MAX_FRAME,
        "MAX_BODY": limits.MAX_BODY,
        "OVERHEAD": limits.OVERHEAD,
        "DELIMITER": frames.DELIMITER[0],
        "MAX_LAWS": limits.MAX_LAWS,
        "MAX_SIGNALS": limits.MAX_SIGNALS,
        "MAX_PARAMETERS": limits.MAX_PARAMETERS,
        "MAX_TELEMETRY_VALUES": limits.MAX_TELEMETRY_VALUES,
    }
    assert ours == rows
    assert max(max(LAYOUTS[it].body_lens) for it in ALL) <= limits.MAX_BODY


def test_the_lists_with_names_are_those_of_the_specification() -> None:
    rows = {row[1]: int(row[0]) for row in table("[R10.12]")}
    assert {name: getattr(limits, name) for name in dir(limits) if name.endswith("_NAMES")} == rows


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
        (Log(LogLevel.INFO, "", 2**32), "Log.device_time_us is 4294967296, allowed is 0 to 4294967295, or None"),
        (
            messages.TorqueAnswer(0, 0.0, TorqueStatus(State(16), TorqueFlags(0)), 0),
            "TorqueAnswer.status is TorqueStatus(state=<State.UNKNOWN_16: 16>",
        ),
        (
            messages.TorqueAnswer(0, 0.0, TorqueStatus(State.IDLE, TorqueFlags(1)), 0),
            "TorqueAnswer.status is TorqueStatus(state=<State.IDLE: 2>",
        ),
    ],
)
def test_a_value_outside_its_field_is_named_with_the_range(message: Message, expected: str) -> None:
    with pytest.raises(FieldError) as raised:
        frames.encode(message)
    assert str(raised.value).startswith(expected)


@pytest.mark.parametrize("number", [-1, 256])
def test_a_number_is_one_byte(number: int) -> None:
    with pytest.raises(FieldError, match=f"Stop.number is {number}, allowed is 0 to 255"):
        frames.encode(messages.Stop(), number)


@pytest.mark.parametrize(
    "body",
    [
        b"\x00",
        b"\x80",
        b"\x81\0",
        b"\xff\0",
        b"\x07",
        b"\x05\0\0\0\0",
        b"\x04\0\0\x00\0\0\0\0",
    ],
    ids=["0", "0x80", "of the drive", "unknown of the drive", "kind alone", "too short", "value of type 0"],
)
def test_a_whole_frame_that_is_no_message_is_rejected(body: bytes) -> None:
    with pytest.raises(BodyError) as raised:
        frames.decode(sealed(body), FROM_HOST)
    assert not isinstance(raised.value, UnknownKindError)


@pytest.mark.parametrize(
    ("body", "number"),
    [(b"\x30\x09abc", 9), (b"\x7f\xff", 255), (b"\x7f", 0), (b"\x1f\x09", 0), (b"\x16", 0)],
    ids=["with fields", "without fields", "kind alone", "without a number", "without a number alone"],
)
def test_a_kind_of_a_newer_peer_is_unknown_and_has_a_number(body: bytes, number: int) -> None:
    for at in (body, bytes([body[0] | 0x80]) + body[1:]):
        with pytest.raises(UnknownKindError, match=f"kind {at[0]:#04x} is not known to protocol version 1.0") as raised:
            frames.decode(sealed(at), direction(at[0]))
        assert (raised.value.kind, raised.value.number) == (at[0], number)


@pytest.mark.parametrize(
    "body",
    [
        b"\x85\0\x06\x00\x01" + bytes(4),
        b"\x85\0\x06\x01\x00" + bytes(4),
        b"\x90" + bytes(6) + b"\x10\0\0",
        b"\x92\0" + bytes(14),
        b"\x93\x00" + bytes(52),
        b"\x93\x01a\0b" + bytes(49),
        b"\x93\x01\xff" + bytes(51),
    ],
    ids=["outcome 0", "state 0", "torque state 0", "fault 0", "level 0", "text after its end", "not UTF-8"],
)
def test_a_field_with_an_invalid_value_is_rejected(body: bytes) -> None:
    with pytest.raises(BodyError):
        frames.decode(sealed(body), FROM_DRIVE)


@pytest.mark.parametrize("values", [State, FaultCode, Outcome, LogLevel, ParameterType])
def test_a_value_without_a_name_is_one_object_and_prints_its_byte(values: type[WireEnum]) -> None:
    assert values(77) is values(77)
    assert (str(values(77)), values(77).label, values(77)) == ("unknown 77", "unknown 77", 77)
    assert not values(77).is_named
    assert values(77) not in list(values)
    assert all(it.is_named for it in values)
    assert copy.deepcopy(values(77)) is pickle.loads(pickle.dumps(values(77))) is values(77)
    wrong: Any
    for wrong in (0, 256, -1, "x"):
        with pytest.raises(ValueError, match=f"not a valid {values.__name__}"):
            values(wrong)


UNKNOWN_VALUE = ParameterValue(ParameterType(77), 0x0403_0201)


@pytest.mark.parametrize(
    "message",
    [
        messages.CommandResult(0x70, Outcome(200), State(255), 5, 6),
        messages.TorqueAnswer(1, 0.5, TorqueStatus(State(15), TorqueFlags(0x90)), 2),
        messages.FaultReport(FaultCode(13), 1, 2.0, 3.0, 4),
        messages.ParameterDescription(
            0, ParameterFlags(0x81), 1, UNKNOWN_VALUE, UNKNOWN_VALUE, UNKNOWN_VALUE, "name", "unit"
        ),
        Log(LogLevel(5), "text"),
        messages.Identity(1, 7, 8, Version(0, 0, 1), 0, 0, State(6), "b", 1, 2, 3, 1, 0, 0, Capabilities(0x81)),
    ],
    ids=lambda it: type(it).__name__,
)
def test_values_and_flags_of_a_newer_drive_are_kept(message: messages.DriveMessage) -> None:
    assert frames.decode(frames.encode(message), FROM_DRIVE) == Numbered(0, message)


def test_a_value_of_an_unknown_type_prints_its_bytes_and_its_type() -> None:
    body = b"\x04\x09\x03\x4d\x01\x02\x03\x04"
    assert frames.decode(sealed(body), FROM_HOST) == Numbered(9, messages.SetParameter(3, UNKNOWN_VALUE))
    assert frames.encode(messages.SetParameter(3, UNKNOWN_VALUE), 9) == sealed(body)
    assert str(UNKNOWN_VALUE) == "0x04030201 (unknown 77)"


def test_capabilities_print_as_words() -> None:
    texts = [str(Capabilities(bits)) for bits in (0, 1, 7, 0x82)]
    assert texts == ["none", "device time", "device time, bench mode, loader", "bench mode, unknown 0x80"]


def body_of(message: Message, number: int = 0) -> bytes:
    """The body in the frame of a message."""
    return frames.open_frame(frames.encode(message, number)[:-1])


OF_LISTS = (messages.SetParameter, messages.SetZero, messages.Capture)
"""Messages with a field of which 0 isn't a value."""

ONE_OF_EACH: list[Message] = [
    *(it(*(0 for _ in LAYOUTS[it].fields)) for it in HOST_MESSAGES if it not in OF_LISTS),
    messages.SetParameter(0, ParameterValue.f32(1.5)),
    messages.SetZero(ZeroSource.PRESENT),
    messages.Capture(1, 2, 3, CaptureTrigger.RISING, 4, 5.0),
    messages.ParameterReport(1, Outcome.ACCEPTED, ParameterValue.u32(2), State.IDLE),
    messages.LineReport(1, 2, 3, 4),
    messages.CommandResult(5, Outcome.INCONSISTENT, State.IDLE, 6),
    messages.LawDescription(0, "law"),
    messages.ChoiceDescription(0, 1, "choice"),
    messages.TorqueAnswer(1, 2.0, TorqueStatus(State.RUNNING, TorqueFlags.GAP), 3),
    messages.FaultReport(FaultCode.WATCHDOG, 1, 2.0, 3.0, 4),
    messages.BenchSample(1, 2, 3, 4, 5.0, TorqueStatus(State.RUNNING, TorqueFlags(0)), 6, 7),
]


@pytest.mark.parametrize("message", ONE_OF_EACH, ids=lambda it: type(it).__name__)
def test_a_longer_body_is_accepted_and_its_rest_ignored(message: Message) -> None:
    layout, number = LAYOUTS[type(message)], 9 if LAYOUTS[type(message)].has_number else 0
    # The device time is absent in these, and would come first.
    whole = body_of(message, 9) + bytes(max(layout.body_lens) - len(body_of(message)))
    expected = frames.decode(sealed(whole), direction(layout.kind))
    assert expected.number == number
    for length in range(1, limits.MAX_BODY - len(whole) + 1):
        assert frames.decode(sealed(whole + b"\xa5" * length), direction(layout.kind)) == expected
    with pytest.raises(BodyError, match=f"bytes, {layout.name} has at least {layout.body_lens[0]}"):
        frames.decode(sealed(whole[: layout.body_lens[0] - 1]), direction(layout.kind))


@pytest.mark.parametrize(
    "message",
    [it for it in ONE_OF_EACH if LAYOUTS[type(it)].fields and LAYOUTS[type(it)].fields[-1].wire.optional]
    + [Log(LogLevel.INFO, "text")],
    ids=lambda it: type(it).__name__,
)
def test_an_optional_field_may_be_absent_or_cut(message: Any) -> None:
    without = body_of(message)
    assert len(without) == LAYOUTS[type(message)].body_lens[0]
    for part in range(4):
        assert frames.decode(sealed(without + b"\xa5" * part), FROM_DRIVE) == Numbered(0, message)
    timed = replace(message, device_time_us=0xA5A5_A5A5)
    assert frames.decode(sealed(without + b"\xa5" * 4), FROM_DRIVE) == Numbered(0, timed)
    assert body_of(timed) == without + b"\xa5" * 4


def test_telemetry_has_1_to_13_values_and_no_other_length() -> None:
    for length in range(64):
        body = b"\x91\x07\x00" + b"\x40" * length
        whole = length % 4 == 0 and 4 <= length <= 52
        if whole:
            telemetry = messages.Telemetry(7, (single(3.0039215),) * (length // 4))
            assert frames.decode(sealed(body), FROM_DRIVE) == Numbered(0, telemetry)
            assert frames.encode(telemetry) == sealed(body)
        elif len(sealed(body)) <= limits.MAX_FRAME:
            allowed = "7 to 55 in steps of 4" if length > 4 else "at least 7"
            with pytest.raises(BodyError, match=f"a body of {3 + length} bytes, Telemetry has {allowed}"):
                frames.decode(sealed(body), FROM_DRIVE)


def test_telemetry_of_six_signals_takes_33_bytes() -> None:
    assert len(frames.encode(messages.Telemetry(0, (1.0,) * 6))) == 33


def test_kinds_of_damage_are_distinguished() -> None:
    whole = frames.encode(messages.Stop(), 7)
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
        if kind in {it.KIND for it in ALL}:
            item = frames.decode(frame, direction(kind))
            assert frames.encode(item.message, item.number) == frame
        else:
            # The example of an unknown request.
            with pytest.raises(UnknownKindError):
                frames.decode(frame, direction(kind))


def test_numbers_have_the_fewest_digits_that_read_back() -> None:
    for text in ["0.1", "0.333333", "0.3333333", "1000000", "-20.5", "0.000972", "1e-09", "nan", "inf", "0"]:
        assert shortest(single(float(text))) == text
