"""The layout of fields in a body, section 3 of `docs/protocol.md`.

A message class declares each field once, annotated with its wire type; the layout follows from the declaration. A body
may be longer than its layout: a newer minor version has added fields, which are ignored.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, fields
from operator import attrgetter, index
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

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
    ZeroSource,
)
from lashloop.errors import FieldError
from lashloop.limits import MAX_TELEMETRY_VALUES

if TYPE_CHECKING:
    from collections.abc import Callable


def has_number(kind: int) -> bool:
    """Whether the number of a request follows the kind byte, also of a kind that nobody knows yet."""
    return kind & 0x70 != 0x10


@dataclass(frozen=True, slots=True)
class Wire:
    """A wire type: its name in the specification, and the conversion of its values.

    `pack` and `unpack` convert between the value and the operand of `struct` for `code`; they raise `ValueError` for
    a value outside the type. None means no conversion. A repeated type, of the last field only, holds `code` at least
    once, up to the end of the body. An optional type, of the last field only, may be absent: its value is None.
    """

    name: str
    code: str
    allowed: str
    pack: Callable[[Any], Any] | None = None
    unpack: Callable[[Any], Any] | None = None
    most: int | None = None
    """Largest number of elements of a repeated type; None for a type of fixed length."""
    optional: bool = False

    def check(self, value: Any) -> None:
        """Raise the error of a value outside the type."""
        if self.optional and value is None:
            return
        if self.most is not None and not 1 <= len(value) <= self.most:
            raise ValueError(value)
        elements = [value] if self.most is None else value
        for element in elements:
            struct.pack("<" + self.code, self.pack(element) if self.pack else element)


def _text(size: int) -> Wire:
    def pack(text: str) -> bytes:
        data = text.encode()
        if len(data) > size or 0 in data:
            raise ValueError(text)
        return data

    def unpack(data: bytes) -> str:
        text, _, padding = data.partition(b"\0")
        if padding.strip(b"\0"):
            raise ValueError(data)
        return text.decode()

    return Wire(f"text[{size}]", f"{size}s", f"at most {size} bytes of UTF-8 without zeros", pack, unpack)


def _pack_value(value: ParameterValue) -> bytes:
    kind = ParameterType(value.type)
    return struct.pack("<Bf" if kind is ParameterType.F32 else "<BI", kind, value.value)


def _unpack_value(data: bytes) -> ParameterValue:
    kind = ParameterType(data[0])
    (number,) = struct.unpack("<f" if kind is ParameterType.F32 else "<I", data[1:])
    return ParameterValue(kind, number)


def _enum(values: type[State | FaultCode | Outcome | LogLevel | ZeroSource | CaptureTrigger]) -> Wire:
    return Wire("enum8", "B", f"a {values.__name__}", values, values)


def _pack_i24(counts: int) -> bytes:
    return index(counts).to_bytes(3, "little", signed=True)


def _unpack_i24(data: bytes) -> int:
    return int.from_bytes(data, "little", signed=True)


def _pack_status(status: TorqueStatus) -> int:
    state, flags = int(State(status.state)), int(status.flags)
    if state & _FLAG_MASK or flags & _STATE_MASK:
        raise ValueError(status)
    return state | flags


def _unpack_status(byte: int) -> TorqueStatus:
    return TorqueStatus(State(byte & _STATE_MASK), TorqueFlags(byte & _FLAG_MASK))


# Bits of a status byte that hold the state; the others are flags.
_STATE_MASK, _FLAG_MASK = 0x0F, 0xF0

U8 = Annotated[int, Wire("u8", "B", "0 to 255")]
U16 = Annotated[int, Wire("u16", "H", "0 to 65535")]
U32 = Annotated[int, Wire("u32", "I", "0 to 4294967295")]
OptionalU32 = Annotated[int | None, Wire("u32", "I", "0 to 4294967295, or None", optional=True)]
I24 = Annotated[int, Wire("i24", "3s", "-8388608 to 8388607", _pack_i24, _unpack_i24)]
F32 = Annotated[float, Wire("f32", "f", "-3.4028235e38 to 3.4028235e38, infinite or NaN")]
F32s = Annotated[
    tuple[float, ...],
    Wire("f32[n]", "f", f"1 to {MAX_TELEMETRY_VALUES} numbers of type f32", most=MAX_TELEMETRY_VALUES),
]
Text10 = Annotated[str, _text(10)]
Text16 = Annotated[str, _text(16)]
Text27 = Annotated[str, _text(27)]
Text28 = Annotated[str, _text(28)]
Text32 = Annotated[str, _text(32)]
Text52 = Annotated[str, _text(52)]
Value = Annotated[ParameterValue, Wire("value", "5s", "a number within its type", _pack_value, _unpack_value)]
VersionField = Annotated[
    Version,
    Wire(
        "version",
        "3s",
        "three numbers from 0 to 255",
        lambda it: bytes((it.major, it.minor, it.patch)),
        lambda data: Version(*data),
    ),
]
StateField = Annotated[State, _enum(State)]
FaultCodeField = Annotated[FaultCode, _enum(FaultCode)]
OutcomeField = Annotated[Outcome, _enum(Outcome)]
LogLevelField = Annotated[LogLevel, _enum(LogLevel)]
ZeroSourceField = Annotated[ZeroSource, _enum(ZeroSource)]
CaptureTriggerField = Annotated[CaptureTrigger, _enum(CaptureTrigger)]
StatusField = Annotated[TorqueStatus, Wire("status8", "B", "a State with TorqueFlags", _pack_status, _unpack_status)]
CapabilitiesField = Annotated[Capabilities, Wire("flags8", "B", "8 bits", None, Capabilities)]
ParameterFlagsField = Annotated[ParameterFlags, Wire("flags8", "B", "8 bits", None, ParameterFlags)]


@dataclass(frozen=True, slots=True)
class Field:
    """A field in the body."""

    name: str
    wire: Wire
    offset: int


class Layout:
    """The body of one kind of message: the kind byte, the number if the kind has one, then the fields."""

    def __init__(self, message: type[Any]) -> None:
        """Derive the layout of a message class from its annotations."""
        hints = get_type_hints(message, include_extras=True)
        wires = [(field.name, _wire_of(hints[field.name])) for field in fields(message)]
        self.name = message.__name__
        self.kind: int = message.KIND
        self.has_number = has_number(self.kind)
        self.message = message
        head = "<BB" if self.has_number else "<B"
        codes = [head, *(wire.code for _, wire in wires)]
        self.fields = tuple(
            Field(name, wire, struct.calcsize("".join(codes[:place]))) for place, (name, wire) in enumerate(wires, 1)
        )
        last = wires[-1][1] if wires else None
        self._is_repeated = last is not None and last.most is not None
        self._is_optional = last is not None and last.optional
        self._before_last = len(wires) - 1
        forms = _forms(head, [wire for _, wire in wires])
        self._by_operands = forms
        self._by_len = {it.size: it for it in forms.values()}
        self._values = _getter([name for name, _ in wires])
        self._packs = [(place, wire.pack) for place, (_, wire) in enumerate(wires) if wire.pack]
        self._unpacks = [(place, wire.unpack) for place, (_, wire) in enumerate(wires) if wire.unpack]

    @property
    def body_lens(self) -> list[int]:
        """Lengths that a body of this version may have, in bytes, ascending."""
        return list(self._by_len)

    def takes(self, length: int) -> bool:
        """Whether a body of this length is accepted: also one with more fields, unless the last field repeats."""
        return self._form(length) is not None

    def encode(self, message: object, number: int = 0) -> bytes:
        """Return the body of a message; `FieldError` for a value outside its field's range."""
        values = list(self._values(message))
        try:
            for place, pack in self._packs:
                values[place] = pack(values[place])
            if self._is_repeated:
                values[self._before_last :] = values[self._before_last]
            elif self._is_optional and values[-1] is None:
                del values[-1]
            head = (self.kind, number) if self.has_number else (self.kind,)
            return self._by_operands[len(values)].pack(*head, *values)
        except (struct.error, ValueError, KeyError, OverflowError, TypeError, AttributeError):
            self._blame(message, number)
            raise

    def decode(self, body: bytes) -> Any:
        """Decode a body of this kind and a length that it takes; `ValueError` if a field has no value of its type."""
        form = self._form(len(body))
        if form is None:
            raise ValueError(body)
        values: list[Any] = list(form.unpack_from(body)[2 if self.has_number else 1 :])
        if self._is_repeated:
            values[self._before_last :] = [tuple(values[self._before_last :])]
        elif len(values) < len(self.fields):
            values.append(None)
        for place, unpack in self._unpacks:
            values[place] = unpack(values[place])
        return self.message(*values)

    def _form(self, length: int) -> struct.Struct | None:
        """Return the longest form within so many bytes, or the one of exactly that length if the last field repeats."""
        if self._is_repeated or length in self._by_len:
            return self._by_len.get(length)
        return next((it for it in reversed(self._by_len.values()) if it.size <= length), None)

    def _blame(self, message: object, number: int) -> None:
        if self.has_number and number not in range(256):
            raise FieldError(self.name, "number", number, "0 to 255") from None
        for field in self.fields:
            value = getattr(message, field.name)
            try:
                field.wire.check(value)
            except (struct.error, ValueError, OverflowError, TypeError, AttributeError):
                raise FieldError(self.name, field.name, value, field.wire.allowed) from None


def _forms(head: str, wires: list[Wire]) -> dict[int, struct.Struct]:
    """Return the forms of a body by the number of values: several if the last field repeats or is optional."""
    if not wires:
        return {0: struct.Struct(head)}
    *others, last = wires
    counts = range(1, last.most + 1) if last.most else range(0 if last.optional else 1, 2)
    before = head + "".join(it.code for it in others)
    return {len(others) + count: struct.Struct(before + last.code * count) for count in counts}


def _wire_of(annotation: Any) -> Wire:
    (wire,) = annotation.__metadata__
    if not isinstance(wire, Wire):
        raise TypeError(f"{annotation} isn't a wire type")
    return wire


def _getter(names: list[str]) -> Callable[[object], tuple[Any, ...]]:
    if len(names) > 1:
        return attrgetter(*names)
    return lambda message: tuple(getattr(message, name) for name in names)
