"""Records as MF4, as other programs read them: every value, unit and event, with the values of our own table."""

from __future__ import annotations

import subprocess
import warnings
from typing import TYPE_CHECKING

import asammdf
import mdfreader
import numpy as np
import pytest

import lashloop
from lashloop.table import Table
from support import WORKSPACE, program
from test_readers import export, start_ns

if TYPE_CHECKING:
    from pathlib import Path

# More than one data block, which hold 4 MB each.
SETTINGS = {
    "run.duration_s": 15.0,
    "expect": [],
    "fault": [{"kind": "torque-gain", "gain": 0.9, "at_s": 0.3, "for_s": 0.4}],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The record of a run of 15000 steps with a fault."""
    out = tmp_path_factory.mktemp("records") / "run"
    lashloop.run(WORKSPACE / "scenarios/shaft-merzouki.toml", set=SETTINGS, device="inproc", out=out, program=program())
    return out


def test_asammdf_reads_every_value_with_its_unit_and_the_events(folder: Path) -> None:
    table = Table.read(export(folder, "csv"))
    with asammdf.MDF(export(folder, "mf4")) as file:
        assert file.version == "4.10"
        assert round(file.start_time.timestamp() * 1e3) == start_ns(folder) // 1_000_000
        assert "law merzouki; PASS" in file.header.description
        assert [(len(it.channels), it.channel_group.cycles_nr) for it in file.groups] == [(len(table), 15_000)]
        for name in table:
            read = file.get(name)
            np.testing.assert_array_equal(read.samples, table[name], err_msg=name)
            np.testing.assert_array_equal(read.timestamps, table["time_s"])
        units = {"torque_nm": "N m", "twist_rad": "rad", "motor_counts": "counts", "send_us": "us", "time_s": "s"}
        assert {name: file.get(name).unit for name in units} == units
        begins, ends = file.events
        assert (begins.name, round(begins.value, 9)) == ("fault 0, torque-gain, begins", 0.3)
        assert (ends.name, round(ends.value, 9)) == ("fault 0, torque-gain, ends", 0.7)
        assert (begins.range_type, ends.range_type, ends.range_start_ev_addr) == (1, 2, begins.address)


def test_mdfreader_reads_every_value_with_its_unit(folder: Path) -> None:
    table = Table.read(export(folder, "csv"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file = mdfreader.Mdf(str(export(folder, "mf4")))
    assert set(file) == set(table)
    for name in table:
        np.testing.assert_array_equal(file.get_channel_data(name), table[name], err_msg=name)
    assert (file.get_channel_unit("torque_nm"), file.get_channel_master("torque_nm")) == ("N m", "time_s")


def test_a_selection_has_its_columns_rows_and_events(folder: Path) -> None:
    options = ["--signal", "twist_rad", "--every", "10", "--from", "0.5", "--until", "1.0"]
    table = Table.read(export(folder, "csv", *options))
    with asammdf.MDF(export(folder, "mf4", *options)) as file:
        assert set(file.channels_db) == {"time_s", "twist_rad"}
        twist = file.get("twist_rad")
        np.testing.assert_array_equal(twist.samples, table["twist_rad"])
        np.testing.assert_array_equal(twist.timestamps, table["time_s"])
        # The fault began before.
        assert [(it.name, it.range_type) for it in file.events] == [("fault 0, torque-gain, ends", 0)]


def test_a_killed_run_is_written_up_to_its_last_chunk(folder: Path, tmp_path: Path) -> None:
    for name in ("record.json", "scenario.toml"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    samples = (folder / "run.mcap").read_bytes()
    (tmp_path / "run.mcap").write_bytes(samples[: len(samples) // 2])
    ended = subprocess.run([program(), "export", tmp_path, "--to", "mf4"], capture_output=True, text=True, check=True)
    assert "interrupted" in ended.stderr
    with asammdf.MDF(tmp_path / "export.mf4") as file:
        assert "interrupted" in file.header.description
        assert 0 < file.groups[0].channel_group.cycles_nr < 15_000
