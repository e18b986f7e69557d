"""Samples of a run of the program, by the `mcap` package."""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
from typing import TYPE_CHECKING

import numpy as np
import pytest
from mcap.reader import make_reader

import lashloop
from lashloop import Record, RecordError
from lashloop.table import Table
from support import WORKSPACE, program

if TYPE_CHECKING:
    from pathlib import Path

SETTINGS = {"run.duration_s": 1.5, "record.flush_rows": 100, "expect": []}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The record of a run of 1500 steps."""
    out = tmp_path_factory.mktemp("records") / "run"
    scenario = WORKSPACE / "scenarios/smooth-after.toml"
    lashloop.run(scenario, set=SETTINGS, device="inproc", out=out, program=program())
    return out


def test_any_reader_of_mcap_finds_schemas_samples_and_attachments(folder: Path) -> None:
    with (folder / "run.mcap").open("rb") as file:
        reader = make_reader(file)
        messages = list(reader.iter_messages(topics=["/step"]))
        attached = {it.name: it.data for it in reader.iter_attachments()}
    assert set(attached) == {"record.json", "scenario.toml", "summary.json"}
    assert json.loads(attached["record.json"]) == Record.read(folder).manifest
    assert attached["scenario.toml"] == (folder / "scenario.toml").read_bytes()
    assert json.loads(attached["summary.json"]) == Record.read(folder).summary
    start_ns = int(messages[0][1].metadata["start_ns"])
    assert [message.log_time for _, _, message in messages] == [start_ns + step * 1_000_000 for step in range(1500)]
    schema, channel, last = messages[-1]
    assert schema is not None
    assert (schema.encoding, channel.message_encoding, channel.topic) == ("ros2msg", "cdr", "/step")
    fields = schema.data.decode().splitlines()
    assert fields[:2] == [
        "float64 reference_rad # reference_rad [rad]",
        "float64 load_position_rad # load_position_rad [rad]",
    ]
    assert last.data[:4] == b"\x00\x01\x00\x00"
    assert struct.unpack_from("<d", last.data, 4 + 8)[0] == Record.read(folder)["load_position_rad"][-1]


def test_the_csv_of_a_run_is_its_samples(folder: Path, tmp_path: Path) -> None:
    csv = tmp_path / "run.csv"
    subprocess.run([program(), "export", folder, "--to", "csv", "--out", csv], stdout=subprocess.DEVNULL, check=True)
    record, table = Record.read(folder), Table.read(csv)
    assert list(table) == [*record.trace, *list(record.timing)[1:]]
    for name, column in table.items():
        np.testing.assert_array_equal(column, record.trace[name] if name in record.trace else record.timing[name])


def test_samples_of_a_killed_run_read_up_to_the_last_whole_chunk(folder: Path, tmp_path: Path) -> None:
    whole, cut = (folder / "run.mcap").read_bytes(), tmp_path / "cut"
    expected = Record.read(folder)["load_position_rad"]
    shutil.copytree(folder, cut)
    (cut / "summary.json").unlink()
    for part in (0.95, 0.7, 0.5):
        (cut / "run.mcap").write_bytes(whole[: int(part * len(whole))])
        record = Record.read(cut)
        assert record.verdict is None
        assert 0 < record.steps < 1500
        assert record.steps % 100 == 0
        np.testing.assert_array_equal(record["load_position_rad"], expected[: record.steps])


def test_samples_that_are_none_are_named(tmp_path: Path) -> None:
    (tmp_path / "record.json").write_text("{}")
    (tmp_path / "run.mcap").write_bytes(b"no samples")
    with pytest.raises(RecordError, match=r"run\.mcap: "):
        Record.read(tmp_path)
