"""The results of a campaign in polars and DuckDB: every number with all its bits, reasons where there is none."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import duckdb
import polars as pl
import pytest

from support import SOON_S, WORKSPACE
from support import program as lashloop_program

if TYPE_CHECKING:
    from pathlib import Path

CASES = 4
MISSING = ["none", "omitted", "never", "cut short", "not finite"]


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a campaign of two plants and two laws."""
    folder = tmp_path_factory.mktemp("campaign") / "out"
    line = ["campaign", "run", "campaigns/small.toml", "--points", "2", "--out", str(folder)]
    subprocess.run([lashloop_program(), *line], cwd=WORKSPACE, check=True, capture_output=True, timeout=4 * SOON_S)
    return folder


def tables(results: Path) -> list[str]:
    """The program of the tests has the feature `parquet`."""
    return [str(results / name) for name in ("results.csv", "results.parquet")]


def test_words_in_place_of_numbers_are_null_beyond_the_rows_that_give_the_types(results: Path, tmp_path: Path) -> None:
    header, *rows = (results / "results.csv").read_text().splitlines()
    place = header.split(",").index("settle_time_s")
    never = rows[0].split(",")
    never[place] = "never"
    table = tmp_path / "long.csv"
    # polars takes types from 100 rows, DuckDB from 20480.
    table.write_text("\n".join([header, *(rows * 6000), ",".join(never)]) + "\n")
    frame = pl.read_csv(table, null_values=MISSING)
    assert frame["settle_time_s"].dtype == pl.Float64
    assert frame["settle_time_s"].null_count() == 1
    numbers = f"read_csv('{table}', nullstr={MISSING})"
    relation = duckdb.sql(f"select count(settle_time_s), sum(settle_time_s) from {numbers}")
    assert relation is not None
    count, total = relation.fetchall()[0]
    assert count == CASES * 6000
    assert total > 0.0


def test_polars_reads_a_row_for_each_run(results: Path) -> None:
    for table in tables(results):
        frame = pl.read_csv(table) if table.endswith(".csv") else pl.read_parquet(table)
        assert frame["case"].to_list() == list(range(CASES))
        assert frame["variant"].to_list() == ["backlash-inverse", "braking-curve"] * 2
        assert frame["settle_time_s"].dtype == pl.Float64
        assert frame["torque_sha256"].str.len_chars().to_list() == [64] * CASES


def test_duckdb_and_polars_read_the_same_numbers(results: Path) -> None:
    for table in tables(results):
        frame = pl.read_csv(table) if table.endswith(".csv") else pl.read_parquet(table)
        query = f'select settle_time_s, "plant.dead_zone_rad" from \'{table}\' order by "case"'
        relation = duckdb.sql(query)
        assert relation is not None
        rows = relation.fetchall()
        assert rows == list(zip(frame["settle_time_s"], frame["plant.dead_zone_rad"], strict=True))
        assert all(0.5 < settle_s < 5.0 for settle_s, _ in rows)


def test_parquet_names_what_the_rows_come_from(results: Path) -> None:
    metadata = pl.read_parquet_metadata(results / "results.parquet")
    facts = {key.removeprefix("lashloop "): value for key, value in metadata.items() if key.startswith("lashloop ")}
    assert facts["seed"] == "1"
    assert len(facts["campaign file's SHA-256"]) == 64
