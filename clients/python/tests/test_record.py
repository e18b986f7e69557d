"""Records: columns as arrays, units, summary, and diagrams."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import pyplot as plt
from mcap.writer import Writer

from lashloop import PlotError, Record, RecordError, Table, UnknownColumnError, Verdict

if TYPE_CHECKING:
    from pathlib import Path

mpl.use("Agg")

COLUMNS = [
    ("time_s", "s"),
    ("reference_rad", "rad"),
    ("load_position_rad", "rad"),
    ("torque_nm", "N m"),
    ("contact", ""),
    ("drive.load_error_rad", "rad"),
    ("telemetry_time_s", "s"),
    ("motor_counts", "counts"),
    ("load_counts", "counts"),
    ("sent_reference_rad", "rad"),
]
STEP = """float64 reference_rad # reference_rad [rad]
float64 load_position_rad # load_position_rad [rad]
float32 torque_nm # torque_nm [N m]
uint8 sampled # sampled []
int32 motor_counts # motor_counts [counts]
int32 load_counts # load_counts [counts]
float32 sent_reference_rad # sent_reference_rad [rad]
float64 contact # contact []
int64 send_ns # send_ns [ns]
"""
DRIVE = "float64 load_error_rad # drive.load_error_rad [rad]\n"
# Load position, torque, contact, time of sending.
STEPS = [(1.5707963267948966, -20.5, 1.0, 1500), (1.5, -20.0, 1.0, -1), (-1e-7, 3.25, -1.0, 2500)]
# Step and load error.
TELEMETRY = [(1, 1.5707963267948966), (2, 1.5)]
SUMMARY = {"verdict": "FAIL", "metrics": {"settle_time_s": 0.001, "lost_motion_rad": None}, "device": "native twin"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The record of a run of three steps, of format 2: messages of ROS 1 at times from 0."""
    with (tmp_path / "run.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start("ros1", "lashloop")

        def channel(topic: str, schema: str) -> int:
            schema_id = writer.register_schema(topic, "ros1msg", schema.encode())
            return writer.register_channel(topic, "ros1", schema_id, {"period_us": "1000"})

        step, drive = channel("/step", STEP), channel("/drive", DRIVE)
        for number, (load_rad, torque_nm, contact, send_ns) in enumerate(STEPS):
            data = struct.pack("<ddfBiifdq", 0.0, load_rad, torque_nm, 1, 0, 0, 0.0, contact, send_ns)
            writer.add_message(step, number * 1_000_000, data, number * 1_000_000)
        for number, error_rad in TELEMETRY:
            time_ns = number * 1_000_000
            writer.add_message(drive, time_ns, struct.pack("<d", error_rad), time_ns, number)
        writer.finish()
    (tmp_path / "record.json").write_text("{}")
    (tmp_path / "summary.json").write_text(json.dumps(SUMMARY))
    return tmp_path


def test_a_record_has_arrays_with_units_by_column(folder: Path) -> None:
    record = Record.read(folder)
    assert record.columns == tuple(name for name, _ in COLUMNS)
    assert record.units == dict(COLUMNS)
    assert record["load_position_rad"].tolist() == [1.5707963267948966, 1.5, -1e-7]
    assert record["drive.load_error_rad"].dtype == np.float64
    np.testing.assert_array_equal(record["drive.load_error_rad"], [np.nan, 1.5707963267948966, 1.5])
    assert record.steps == len(record["time_s"]) == 3


def test_a_record_has_the_summary_the_metrics_and_the_verdict(folder: Path) -> None:
    record = Record.read(str(folder))
    assert record.verdict is Verdict.FAIL
    assert record.verdict == "FAIL"
    assert str(record.verdict) == "FAIL"
    assert record.metrics == {"settle_time_s": 0.001, "lost_motion_rad": None}
    assert record.summary["device"] == "native twin"
    np.testing.assert_array_equal(record.timing["send_us"], [1.5, np.nan, 2.5])


def test_an_interrupted_run_has_no_verdict(folder: Path) -> None:
    (folder / "summary.json").unlink()
    samples = folder / "run.mcap"
    samples.write_bytes(samples.read_bytes()[:-20])
    record = Record.read(folder)
    assert (record.verdict, record.metrics, record.steps) == (None, {}, 3)


def test_an_unknown_column_names_similar_ones(folder: Path) -> None:
    record = Record.read(folder)
    for name, expected in (
        ("load_position", "did you mean load_position_rad"),
        ("load_error_rad", r"did you mean drive\.load_error_rad"),
        ("x", "it has time_s, reference_rad, "),
    ):
        with pytest.raises(UnknownColumnError, match=f"the record has no column {name}; {expected}"):
            record[name]


def test_columns_can_not_be_written_to(folder: Path) -> None:
    torque_nm = Record.read(folder)["torque_nm"]
    with pytest.raises(ValueError, match="read-only"):
        torque_nm[0] = 0.0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (None, r"t.csv: can't be read: No such file"),
        ("time_s,a\n", r"t.csv: has no rows"),
        ("", r"t.csv: has no rows"),
        ("time_s,a\n1,2\n3,x\n", r"t.csv: is not a table of numbers: .*'x'"),
        ("time_s,a\n1,2\n3\n", r"t.csv: is not a table of numbers: "),
        ("time_s,a\n1,2,3\n", r"t.csv: has 3 fields in a row, its header has 2"),
    ],
)
def test_a_table_of_no_numbers_is_named(tmp_path: Path, text: str | None, expected: str) -> None:
    if text is not None:
        (tmp_path / "t.csv").write_text(text)
    with pytest.raises(RecordError, match=expected):
        Table.read(tmp_path / "t.csv")


@pytest.mark.parametrize(
    ("file", "text", "expected"),
    [
        ("run.mcap", None, r"run.mcap: can't be read: No such file"),
        ("run.mcap", "no samples", r"run.mcap: "),
        ("record.json", None, r"record.json: can't be read: No such file"),
        ("record.json", "{", r"record.json: is not JSON"),
        ("summary.json", "PASS", r"summary.json: is not JSON"),
        ("summary.json", "[]", r"summary.json: has no verdict"),
        ("summary.json", '{"verdict": "GOOD"}', r"summary.json: has no verdict"),
    ],
)
def test_a_file_that_is_no_part_of_a_record_is_named(folder: Path, file: str, text: str | None, expected: str) -> None:
    (folder / file).unlink()
    if text is not None:
        (folder / file).write_text(text)
    with pytest.raises(RecordError, match=f"{expected}.*; `lashloop run --out` writes a record"):
        Record.read(folder)


def test_a_plot_has_one_diagram_for_each_unit(folder: Path) -> None:
    figure = Record.read(folder).plot("load_position_rad", "torque_nm", "reference_rad")
    diagrams = figure.axes
    assert [it.get_ylabel() for it in diagrams] == ["rad", "N m"]
    drawn = [[line.get_label() for line in it.get_lines()] for it in diagrams]
    assert drawn == [["load_position_rad", "reference_rad"], ["torque_nm"]]
    np.testing.assert_array_equal(diagrams[1].get_lines()[0].get_ydata(), [-20.5, -20.0, 3.25])
    assert diagrams[-1].get_xlabel() == "time, s"
    plt.close(figure)


def test_a_plot_has_the_steps_of_its_window_only(folder: Path) -> None:
    figure = Record.read(folder).plot("contact", from_s=0.001, to_s=0.0015)
    np.testing.assert_array_equal(figure.axes[0].get_lines()[0].get_xdata(), [0.001])
    plt.close(figure)


def test_a_plot_goes_into_axes_of_its_own_or_of_the_caller(folder: Path) -> None:
    figure, axes = plt.subplots()
    record = Record.read(folder)
    assert record.plot("load_position_rad", "torque_nm", axes=axes) is figure
    assert len(axes.get_lines()) == 2
    assert axes.get_ylabel() == "rad, N m"
    plt.close(figure)


def test_a_plot_without_content_is_an_error(folder: Path) -> None:
    record = Record.read(folder)
    with pytest.raises(PlotError, match="no column to draw; the record has time_s, "):
        record.plot()
    with pytest.raises(PlotError, match=r"no step from 1.0 s to None s; the run is from 0.0 s to 0.002 s"):
        record.plot("torque_nm", from_s=1.0)
    with pytest.raises(UnknownColumnError):
        record.plot("torque")
    assert plt.get_fignums() == []


def test_a_record_needs_no_matplotlib_until_it_is_drawn(folder: Path) -> None:
    code = f"""
import sys
sys.modules["matplotlib"] = None
import lashloop
record = lashloop.Record.read({str(folder)!r})
try:
    record.plot("torque_nm")
except lashloop.PlotError as error:
    print(error)
"""
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout == "a plot needs matplotlib: `pip install matplotlib`\n"
