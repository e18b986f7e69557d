"""The layout of fields in a body, section 3 of `docs/protocol.md`.

A message class declares each field once, annotated with its wire type; the layout follows from the declaration.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, fields
from operator import attrgetter, index
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

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
)
from lashloop.errors import FieldError

if TYPE_CHECKING:
    from collections.abc import Callable


MAX_FRAME = 64
"""Longest frame in bytes, COBS code and delimiter included."""
OVERHEAD = 6
"""Bytes of a frame beyond its body."""
MAX_BODY = MAX_FRAME - OVERHEAD
"""Longest body in bytes."""
MAX_TELEMETRY_VALUES = (MAX_BODY - 3) // 4
"""Most values of one telemetry: what the longest body holds besides kind and sequence."""


@dataclass(frozen=True, slots=True)
class Wire:
    """A wire type: its name in the specification, and the conversion of its values.

    `pack` and `unpack` convert between the value and the operand of `struct` for `code`; they raise `ValueError` for
    a value outside the type. None means no conversion. A repeated type, of the last field only, holds `code` at least
    once, up to the end of the body.
    """

    name: str
    code: str
    allowed: str
    pack: Callable[[Any], Any] | None = None
    unpack: Callable[[Any], Any] | None = None
    most: int | None = None
    """Largest number of elements of a repeated type; None for a type of fixed length."""

    def check(self, value: Any) -> None:
        """Raise the error of a value outside the type."""
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
    return struct.pack("<BI" if value.type is ParameterType.U32 else "<Bf", value.type, value.value)


def _unpack_value(data: bytes) -> ParameterValue:
    kind = ParameterType(data[0])
    (number,) = struct.unpack("<I" if kind is ParameterType.U32 else "<f", data[1:])
    return ParameterValue(kind, number)


def _enum(values: type[State | FaultCode | Outcome | LogLevel]) -> Wire:
    return Wire("enum8", "B", f"a {values.__name__}", values, values)


def _pack_i24(counts: int) -> bytes:
    return index(counts).to_bytes(3, "little", signed=True)


def _unpack_i24(data: bytes) -> int:
    return int.from_bytes(data, "little", signed=True)


def _pack_status(status: TorqueStatus) -> int:
    return State(status.state) | _named_flags(status.flags)


def _unpack_status(byte: int) -> TorqueStatus:
    return TorqueStatus(State(byte & _STATE_MASK), _named_flags(byte & ~_STATE_MASK))


def _named_flags(bits: int) -> TorqueFlags:
    if bits & ~_ALL_TORQUE_FLAGS:
        raise ValueError(bits)
    return TorqueFlags(bits)


_ALL_TORQUE_FLAGS = sum(TorqueFlags)
# Bits of a status byte that hold the state; the others are flags.
_STATE_MASK = 0x0F

U8 = Annotated[int, Wire("u8", "B", "0 to 255")]
U16 = Annotated[int, Wire("u16", "H", "0 to 65535")]
U32 = Annotated[int, Wire("u32", "I", "0 to 4294967295")]
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
Value = Annotated[ParameterValue, Wire("value", "5s", "a U32 or an F32 within its type", _pack_value, _unpack_value)]
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
StatusField = Annotated[TorqueStatus, Wire("status8", "B", "a State with TorqueFlags", _pack_status, _unpack_status)]
# Unlike a torque flag, a bit without a name isn't an error.
ParameterFlagsField = Annotated[ParameterFlags, Wire("flags8", "B", "8 bits", None, ParameterFlags)]


@dataclass(frozen=True, slots=True)
class Field:
    """A field in the body."""

    name: str
    wire: Wire
    offset: int


class Layout:
    """The body of one kind of message: the kind byte, then the fields."""

    def __init__(self, message: type[Any]) -> None:
        """Derive the layout of a message class from its annotations."""
        hints = get_type_hints(message, include_extras=True)
        wires = [(field.name, _wire_of(hints[field.name])) for field in fields(message)]
        self.name = message.__name__
        self.kind: int = message.KIND
        self.message = message
        self.fields = tuple(
            Field(name, wire, struct.calcsize("<B" + "".join(it.code for _, it in wires[:place])))
            for place, (name, wire) in enumerate(wires)
        )
        most = wires[-1][1].most if wires else None
        self._is_repeated = most is not None
        self._fixed = len(wires) - self._is_repeated
        fixed_codes = "<B" + "".join(wire.code for _, wire in wires[: self._fixed])
        structs = (
            [struct.Struct(fixed_codes)]
            if most is None
            else [struct.Struct(fixed_codes + wires[-1][1].code * count) for count in range(1, most + 1)]
        )
        self._by_operands = dict(enumerate(structs, len(wires)))
        self._by_len = {it.size: it for it in structs}
        self._values = _getter([name for name, _ in wires])
        self._packs = [(place, wire.pack) for place, (_, wire) in enumerate(wires) if wire.pack]
        self._unpacks = [(place, wire.unpack) for place, (_, wire) in enumerate(wires) if wire.unpack]

    @property
    def body_lens(self) -> list[int]:
        """Lengths that a body of this kind may have, in bytes; one, unless the last field repeats."""
        return list(self._by_len)

    def encode(self, message: object) -> bytes:
        """Return the body of a message; `FieldError` for a value outside its field's range."""
        values = list(self._values(message))
        try:
            for place, pack in self._packs:
                values[place] = pack(values[place])
            if self._is_repeated:
                values[self._fixed :] = values[self._fixed]
            return self._by_operands[len(values)].pack(self.kind, *values)
        except (struct.error, ValueError, KeyError, OverflowError, TypeError, AttributeError):
            self._blame(message)
            raise

    def decode(self, body: bytes) -> Any:
        """Decode a body of this kind and of one of its lengths; `ValueError` if a field holds no value of its type."""
        values: list[Any] = list(self._by_len[len(body)].unpack(body)[1:])
        if self._is_repeated:
            values[self._fixed :] = [tuple(values[self._fixed :])]
        for place, unpack in self._unpacks:
            values[place] = unpack(values[place])
        return self.message(*values)

    def _blame(self, message: object) -> None:
        for field in self.fields:
            value = getattr(message, field.name)
            try:
                field.wire.check(value)
            except (struct.error, ValueError, OverflowError, TypeError, AttributeError):
                raise FieldError(self.name, field.name, value, field.wire.allowed) from None


def _wire_of(annotation: Any) -> Wire:
    (wire,) = annotation.__metadata__
    if not isinstance(wire, Wire):
        raise TypeError(f"{annotation} isn't a wire type")
    return wire


def _getter(names: list[str]) -> Callable[[object], tuple[Any, ...]]:
    if len(names) > 1:
        return attrgetter(*names)
    return lambda message: tuple(getattr(message, name) for name in names)
