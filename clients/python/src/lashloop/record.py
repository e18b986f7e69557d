"""The record of a run, as `lashloop run --out` leaves it in a folder.

| file | content |
|---|---|
| `record.json` | what was run: command line, scenario, overrides, parameters, host, versions |
| `run.mcap` | every step with all its bits: positions, torque, signals of plant and drive, timing |
| `summary.json` | verdict, metrics, expectations, counters of the link; absent if the run was interrupted |
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lashloop.plot import draw
from lashloop.samples import Samples
from lashloop.table import RecordError, Table

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

TIME = "time_s"


class Verdict(str, Enum):
    """Result of a run."""

    PASS = "PASS"
    """Every expectation is met."""
    FAIL = "FAIL"
    """An expectation is missed."""
    INVALID = "INVALID"
    """Link or timing exceeded what the scenario allows, so the run says nothing about the drive."""

    def __str__(self) -> str:
        """Return the word."""
        return self.value


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Record:
    """A run: columns of the trace as arrays, with units, and the summary."""

    folder: Path | None
    """Where the files are; None if they were temporary."""
    trace: Table
    """Every column of the run; `record["torque_nm"]` is short for `record.trace["torque_nm"]`."""
    units: Mapping[str, str]
    """Unit of each column; empty for a pure number."""
    timing: Table
    """Timing of each step in us."""
    manifest: Mapping[str, Any]
    """`record.json`: what was run."""
    summary: Mapping[str, Any]
    """`summary.json`; empty if the run was interrupted."""

    @classmethod
    def read(cls, folder: str | os.PathLike[str]) -> Record:
        """Read the record in a folder; `RecordError` names the file that can't be read."""
        path = Path(folder)
        manifest, samples = _json(path / "record.json"), Samples.read(path / "run.mcap")
        summary = path / "summary.json"
        return cls(
            folder=path,
            trace=samples.trace,
            units=samples.units,
            timing=samples.timing,
            manifest=manifest,
            summary=_summary(summary) if summary.exists() else {},
        )

    def __repr__(self) -> str:
        """Name the run and its size."""
        run = f"{self.summary['scenario']} on {self.summary['device']}, " if self.summary else ""
        return f"<Record: {run}{self.steps} steps, {len(self.trace)} columns, verdict {self.verdict}>"

    def __getitem__(self, column: str) -> NDArray[np.float64]:
        """Return a column of the trace; `UnknownColumnError` names similar ones."""
        return self.trace[column]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of the trace."""
        return tuple(self.trace)

    @property
    def steps(self) -> int:
        """Number of control steps in the trace."""
        return len(self.trace[TIME])

    @property
    def verdict(self) -> Verdict | None:
        """Result of the run; None if the run was interrupted."""
        return Verdict(self.summary["verdict"]) if self.summary else None

    @property
    def metrics(self) -> Mapping[str, float | None]:
        """Metrics by name, in the unit at the end of the name; None where the run gives no value."""
        metrics: Mapping[str, float | None] = self.summary.get("metrics", {})
        return metrics

    @property
    def metrics_without_value(self) -> Mapping[str, str]:
        """Why a metric has no value, by name."""
        reasons: Mapping[str, str] = self.summary.get("metrics_without_value", {})
        return reasons

    def plot(
        self, *columns: str, from_s: float | None = None, to_s: float | None = None, axes: Axes | None = None
    ) -> Figure:
        """Draw columns over time: one diagram for each unit, or all of them into `axes`. Requires matplotlib."""
        return draw(self.trace, self.units, columns, from_s, to_s, axes)


def _summary(path: Path) -> dict[str, Any]:
    summary = _json(path)
    if not isinstance(summary, dict) or summary.get("verdict") not in list(Verdict):
        raise RecordError(path, f"has no verdict of {', '.join(Verdict)}")
    return summary


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordError(path, f"can't be read: {error.strerror}") from error
    except ValueError as error:
        raise RecordError(path, f"is not JSON: {error}") from error
