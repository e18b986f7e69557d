"""The law of the profile `pd` from its section, against the golden trace."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pytest

from lashloop.control import ControlInput
from lashloop.control.cascade import CascadedPd
from lashloop.counts import wrapping_difference
from lashloop.enums import single
from specified_pd import SpecifiedPd
from support import WORKSPACE, table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lashloop.control import Controller

GOLDEN = WORKSPACE / "protocol/golden"
RUNS = ["coarse", "fine"]


class Row(NamedTuple):
    """A row of the trace."""

    sequence: int
    motor_counts: int
    load_counts: int
    reference_rad: float
    torque_nm: float
    flags: str


def parameters(run: str) -> dict[str, float]:
    with (GOLDEN / "pd-parameters.csv").open(newline="") as file:
        return {row["name"]: float(row[run]) for row in csv.DictReader(file)}


def rows(run: str) -> list[Row]:
    with (GOLDEN / "pd.csv").open(newline="") as file:
        return [
            Row(
                int(it["sequence"]),
                int(it["motor_counts"]),
                int(it["load_counts"]),
                single(float(it["reference_rad"])),
                float(it["torque_nm"]),
                it["flags"],
            )
            for it in csv.DictReader(file)
            if it["run"] == run
        ]


def replayed(law: Controller, run: str) -> Iterator[tuple[Row, float]]:
    """Each row, with the torque of the law within the limit."""
    limit_nm = parameters(run)["torque_limit_nm"]
    motor = load = 0
    before: Row | None = None
    for row in rows(run):
        if before is None:
            motor, load, periods = row.motor_counts, row.load_counts, 1
        else:
            motor += wrapping_difference(row.motor_counts, before.motor_counts)
            load += wrapping_difference(row.load_counts, before.load_counts)
            periods = row.sequence - before.sequence
        before = row
        torque_nm = law.step(ControlInput(motor, load, row.reference_rad, 0.0, periods)).torque_nm
        yield row, min(max(torque_nm, -limit_nm), limit_nm)


def tolerance_nm() -> float:
    return next(float(row[1]) for row in table("### Golden trace") if row[0] == "tolerance")


@pytest.mark.parametrize("run", RUNS)
def test_the_law_of_the_section_gives_the_bits_of_the_trace_in_single_precision(run: str) -> None:
    for row, torque_nm in replayed(SpecifiedPd(parameters(run), np.float32), run):
        assert np.float32(torque_nm) == np.float32(row.torque_nm), row


@pytest.mark.parametrize("run", RUNS)
def test_the_law_of_the_section_is_within_the_tolerance_in_double_precision(run: str) -> None:
    largest_nm = max(
        abs(torque - row.torque_nm) for row, torque in replayed(SpecifiedPd(parameters(run), np.float64), run)
    )
    assert largest_nm <= tolerance_nm() / 4, "with a margin for other orders of operations"


@pytest.mark.parametrize("run", RUNS)
def test_the_law_of_the_package_gives_the_bits_of_the_trace(run: str) -> None:
    for row, torque_nm in replayed(CascadedPd({"dead_zone_rad": 0.1} | parameters(run)), run):
        assert np.float32(torque_nm) == np.float32(row.torque_nm), row


@pytest.mark.parametrize("run", RUNS)
def test_the_parameters_of_the_trace_are_those_of_the_section(run: str) -> None:
    column = 3 + RUNS.index(run)
    assert {row[0]: float(row[column]) for row in table("### Parameters of the profile")} == parameters(run)
