"""Records as other programs read them: every message in both directions, with the values of our own table."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

import lashloop
from lashloop.table import Table
from support import WORKSPACE, program

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

READERS = WORKSPACE / "target/python"
SETTINGS = {
    "run.duration_s": 1.5,
    "record.flush_rows": 100,
    "expect": [],
    "fault": [{"kind": "torque-gain", "gain": 0.9, "at_s": 0.3, "for_s": 0.4}],
}
PERIOD_NS = 1_000_000
EDGES = [("/fault", "torque-gain", 0, 1, 300), ("/fault", "torque-gain", 0, 0, 700)]


class Message(NamedTuple):
    """A message that a program has decoded."""

    topic: str
    log_ns: int
    publish_ns: int
    values: dict[str, Any]


def by_python(path: Path, *, is_reversed: bool) -> list[Message]:
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        decoded = list(reader.iter_decoded_messages(reverse=is_reversed))
    return [
        Message(channel.topic, message.log_time, message.publish_time, {it: getattr(ros, it) for it in ros.__slots__})
        for _, channel, message, ros in decoded
    ]


def by_foxglove(path: Path, *, is_reversed: bool) -> list[Message]:
    words = [Path(sys.executable).parent / "node", Path(__file__).parent / "readers/read_mcap.cjs", path]
    environment = os.environ | {"NODE_PATH": str(READERS / "node_modules")}
    order = "backwards" if is_reversed else "forwards"
    ended = subprocess.run([*words, order], env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    messages = map(json.loads, ended.stdout.splitlines())
    return [Message(topic, int(log), int(publish), values) for topic, log, publish, values in messages]


@pytest.fixture(params=[by_python, by_foxglove])
def read(request: pytest.FixtureRequest) -> Callable[..., list[Message]]:
    """A program that reads MCAP."""
    reader: Callable[..., list[Message]] = request.param
    return reader


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The record of a run of 1500 steps with a fault."""
    out = tmp_path_factory.mktemp("records") / "run"
    lashloop.run(WORKSPACE / "scenarios/shaft-merzouki.toml", set=SETTINGS, device="inproc", out=out, program=program())
    return out


@pytest.fixture
def killed(folder: Path, tmp_path: Path) -> Path:
    """What is left of the run if it is killed in its tenth chunk."""
    cut = tmp_path / "cut"
    shutil.copytree(folder, cut)
    (cut / "summary.json").unlink()
    samples = (cut / "run.mcap").read_bytes()
    (cut / "run.mcap").write_bytes(samples[: len(samples) * 2 // 3])
    return cut


def export(folder: Path, to: str, *options: str) -> Path:
    subprocess.run([program(), "export", folder, "--to", to, *options], capture_output=True, check=True)
    return folder / f"export.{to}"


def start_ns(folder: Path) -> int:
    started = datetime.fromisoformat(json.loads((folder / "record.json").read_text())["started"].replace("Z", "+00:00"))
    return (started - datetime.fromisoformat("1970-01-01T00:00:00+00:00")) // timedelta(microseconds=1) * 1000


def columns(path: Path, topic: str) -> dict[str, tuple[str, str]]:
    """Name and unit of the column of each field of a topic."""
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    channel = next(it for it in summary.channels.values() if it.topic == topic)
    schema = summary.schemas[channel.schema_id]
    assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
    lines = [line.partition(" # ") for line in schema.data.decode().splitlines()]
    fields = {declaration.split()[1]: comment.rpartition(" [") for declaration, _, comment in lines}
    return {field: (name, unit.removesuffix("]")) for field, (name, _, unit) in fields.items()}


def column(name: str, unit: str, values: NDArray[np.float64]) -> tuple[str, NDArray[np.float64]]:
    """The column of our own table that a field stands for."""
    if unit != "ns":
        return name, values
    return f"{name.removesuffix('_ns')}_us", np.where(values == -1, np.nan, values / 1e3)


def assert_same_values(path: Path, topic: str, messages: list[Message], table: Table, rows: list[int]) -> None:
    """Checks every value of the messages of a topic, which belong to these rows."""
    for field, (name, unit) in columns(path, topic).items():
        values = np.array([float(it.values[field]) for it in messages])
        if name == "sampled":
            assert (values == 1).all()
            continue
        in_table, values = column(name, unit, values)
        np.testing.assert_array_equal(values, table[in_table][rows], err_msg=f"{topic} {field}")


def assert_whole(messages: list[Message], path: Path, folder: Path) -> None:
    """Checks that a program has read the run, every message in the order of its time."""
    table, start = Table.read(export(folder, "csv")), start_ns(folder)
    assert [it.log_ns for it in messages] == sorted(it.log_ns for it in messages)
    steps = [it for it in messages if it.topic == "/step"]
    rows = list(range(len(table["time_s"])))
    assert [it.log_ns for it in steps] == [it.publish_ns for it in steps] == [start + row * PERIOD_NS for row in rows]
    assert_same_values(path, "/step", steps, table, rows)
    telemetry = [it for it in messages if it.topic == "/drive"]
    arrivals = [(it.publish_ns - start) // PERIOD_NS for it in telemetry]
    assert arrivals == rows[::10]
    assert_same_values(path, "/drive", telemetry, table, arrivals)
    sampled_s = np.array([(it.log_ns - start) / 1e9 for it in telemetry])
    np.testing.assert_allclose(sampled_s, table["telemetry_time_s"][arrivals], rtol=0, atol=1e-9)
    edges = [
        (it.topic, *(it.values[name] for name in ("kind", "number", "begins")), (it.log_ns - start) // PERIOD_NS)
        for it in messages
        if it.topic == "/fault"
    ]
    assert edges == [edge for edge in EDGES if edge[-1] < len(rows)]
    assert len(messages) == len(steps) + len(telemetry) + len(edges)


def test_a_run_reads_in_both_directions(folder: Path, read: Callable[..., list[Message]]) -> None:
    path = folder / "run.mcap"
    forwards, backwards = read(path, is_reversed=False), read(path, is_reversed=True)
    assert_whole(forwards, path, folder)
    assert_whole(backwards[::-1], path, folder)


def test_the_copy_of_a_killed_run_reads_in_both_directions(killed: Path, read: Callable[..., list[Message]]) -> None:
    path = export(killed, "mcap")
    forwards, backwards = read(path, is_reversed=False), read(path, is_reversed=True)
    assert 0 < sum(it.topic == "/step" for it in forwards) < 1500
    assert_whole(forwards, path, killed)
    assert_whole(backwards[::-1], path, killed)


def test_a_selection_reads_in_both_directions(folder: Path, read: Callable[..., list[Message]]) -> None:
    options = ["--signal", "twist_rad", "send_us", "--every", "10", "--from", "0.5"]
    table = Table.read(export(folder, "csv", *options))
    path = export(folder, "mcap", *options)
    for is_reversed in (False, True):
        messages = read(path, is_reversed=is_reversed)
        ordered = messages[::-1] if is_reversed else messages
        assert [it.log_ns for it in ordered] == [start_ns(folder) + row * PERIOD_NS for row in range(500, 1500, 10)]
        for name in ("time_s", "twist_rad", "send_us"):
            np.testing.assert_array_equal([float(it.values[name]) for it in ordered], table[name])
