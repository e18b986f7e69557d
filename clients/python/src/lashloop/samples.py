"""The samples of a run, `run.mcap`: every column with the bits that it had in the run.

A message has fields of fixed size, packed as CDR: behind a head of four bytes, each at a multiple of its size. Its
schema is the text of a ROS 2 message. The comment of a field is `NAME [UNIT]` of its column. Times are in ns since
1970. Records of format 2 have messages of ROS 1, without head and padding, at times from 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from mcap.exceptions import McapError
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader

from lashloop.table import RecordError, Table

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

TYPES = {"float64": "<f8", "float32": "<f4", "int64": "<i8", "int32": "<i4", "uint8": "u1"}
SENT = ("motor_counts", "load_counts", "sent_reference_rad")
NO_TIME_NS = -1
MAGIC = b"\x89MCAP0\r\n"
CDR_HEAD = 4


@dataclass(frozen=True, slots=True)
class Samples:
    """Trace and timing of a run."""

    trace: Table
    units: dict[str, str]
    timing: Table
    is_torn: bool
    """Whether the file has no end: the run was interrupted. The columns go up to the last whole chunk."""

    @classmethod
    def read(cls, path: Path) -> Samples:
        """Read a file; `RecordError` names one that can't be read."""
        topics: dict[str, _Topic] = {}
        try:
            with path.open("rb") as file:
                file.seek(-min(len(MAGIC), path.stat().st_size), 2)
                is_torn = file.read() != MAGIC
                file.seek(0)
                _collect(file, topics, is_torn=is_torn)
        except OSError as error:
            raise RecordError(path, f"can't be read: {error.strerror}") from error
        except (McapError, ValueError) as error:
            raise RecordError(path, f"isn't an MCAP file of a run: {error}") from error
        step = topics.get("/step")
        if step is None or not step.numbers:
            raise RecordError(path, "has no steps")
        return _assembled(step, topics.get("/drive"), is_torn=is_torn)


@dataclass(slots=True)
class _Topic:
    columns: list[tuple[str, str]]
    dtype: np.dtype[Any]
    period_us: int
    start_ns: int
    numbers: list[int] = field(default_factory=list)
    times_ns: list[int] = field(default_factory=list)
    messages: list[bytes] = field(default_factory=list)

    @classmethod
    def of(cls, channel: Channel, schema: Schema) -> _Topic:
        columns: list[tuple[str, str]] = []
        types: list[str] = []
        for line in schema.data.decode().splitlines():
            declaration, _, comment = line.partition(" # ")
            name, _, unit = comment.removesuffix("]").rpartition(" [")
            columns.append((name, unit))
            types.append(TYPES[declaration.split()[0]])
        dtype = _dtype(types, channel.message_encoding)
        return cls(columns, dtype, int(channel.metadata["period_us"]), int(channel.metadata.get("start_ns", "0")))

    def values(self) -> dict[str, NDArray[np.float64]]:
        rows = np.frombuffer(b"".join(self.messages), dtype=self.dtype)
        names = self.dtype.names or ()
        return {name: rows[at].astype(np.float64) for (name, _), at in zip(self.columns, names, strict=True)}


def _dtype(types: list[str], encoding: str) -> np.dtype[Any]:
    names = [f"f{number}" for number in range(len(types))]
    if encoding == "ros1":
        return np.dtype(list(zip(names, types, strict=True)))
    if encoding != "cdr":
        raise ValueError(f"its messages are encoded as {encoding}; this version reads cdr and ros1")
    offsets, end = [], CDR_HEAD
    for size in (np.dtype(it).itemsize for it in types):
        end += -(end - CDR_HEAD) % size
        offsets.append(end)
        end += size
    return np.dtype({"names": names, "formats": types, "offsets": offsets, "itemsize": end})


def _collect(file: Any, topics: dict[str, _Topic], *, is_torn: bool) -> None:
    schemas: dict[int, Schema] = {}
    channels: dict[int, _Topic] = {}
    try:
        for record in StreamReader(file).records:
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel) and record.topic in ("/step", "/drive"):
                if record.id not in channels:
                    topics[record.topic] = channels[record.id] = _Topic.of(record, schemas[record.schema_id])
            elif isinstance(record, Message) and record.channel_id in channels:
                topic = channels[record.channel_id]
                topic.numbers.append(record.sequence)
                topic.times_ns.append(record.log_time - topic.start_ns)
                topic.messages.append(record.data)
    except Exception:
        # The reader has an error of its own for each place at which a killed run may have cut the file.
        if not is_torn:
            raise


def _assembled(step: _Topic, drive: _Topic | None, *, is_torn: bool) -> Samples:
    values, units = step.values(), dict(step.columns)
    period_s, period_ns = step.period_us / 1e6, step.period_us * 1000
    numbers = np.array(step.times_ns) // period_ns
    sampled = values.pop("sampled") != 0
    sent = {name: np.where(sampled, values.pop(name), np.nan) for name in SENT}
    timing = {"step": numbers.astype(np.float64)}
    for name, unit in step.columns:
        if unit == "ns":
            time_ns = values.pop(name)
            timing[f"{name.removesuffix('_ns')}_us"] = np.where(time_ns == NO_TIME_NS, np.nan, time_ns / 1e3)
        elif name in ("answered", "missed"):
            timing[name] = values.pop(name)
    trace = {"time_s": numbers * period_s, **values}
    telemetry_time_s = np.full(len(numbers), np.nan)
    if drive is not None and drive.numbers:
        # The last telemetry up to each step; -1 before the first.
        latest = np.searchsorted(np.array(drive.numbers), numbers, side="right") - 1
        for name, column in drive.values().items():
            trace[name] = np.where(latest >= 0, column[latest], np.nan)
        times_s = np.round(np.array(drive.times_ns) / period_ns) * period_s
        telemetry_time_s = np.where(latest >= 0, times_s[latest], np.nan)
    elif drive is not None:
        trace.update({name: np.full(len(numbers), np.nan) for name, _ in drive.columns})
    trace |= {"telemetry_time_s": telemetry_time_s, **sent}
    units |= dict(drive.columns) if drive is not None else {}
    units |= {"time_s": "s", "telemetry_time_s": "s"}
    return Samples(Table(trace), {name: units[name] for name in trace}, Table(timing), is_torn)
