"""A table of numbers with named columns, as in a record or in the CSV of `lashloop export`."""

from __future__ import annotations

import difflib
import io
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from lashloop.errors import LashloopError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray


class RecordError(LashloopError):
    """The record of a run can't be read."""

    def __init__(self, path: Path, reason: str) -> None:
        """Name the file and the reason."""
        super().__init__(f"{path}: {reason}; `lashloop run --out` writes a record")
        self.path, self.reason = path, reason


class UnknownColumnError(LashloopError, KeyError):
    """The table has no column of this name."""

    def __init__(self, name: str, columns: list[str]) -> None:
        """Name the column and similar ones."""
        nearest = difflib.get_close_matches(name, columns)
        # A signal of the drive has a prefix.
        nearest += [it for it in columns if it.endswith(f".{name}") and it not in nearest]
        hint = f"did you mean {' or '.join(nearest)}?" if nearest else f"it has {', '.join(columns)}"
        self._sentence = f"the record has no column {name}; {hint}"
        super().__init__(self._sentence)
        self.name, self.nearest = name, nearest

    def __str__(self) -> str:
        """Return the sentence, which `KeyError` would quote."""
        return self._sentence


def _number(field: str) -> float:
    return float(field) if field else float("nan")


class Table(Mapping[str, "NDArray[np.float64]"]):
    """Columns by name, each an array with one number per row. The arrays can't be written to."""

    def __init__(self, columns: Mapping[str, NDArray[np.float64]]) -> None:
        """Keep the columns, which have equal lengths."""
        self._columns = dict(columns)
        for column in self._columns.values():
            column.flags.writeable = False

    @classmethod
    def read(cls, path: Path) -> Table:
        """Read a file. A last line without a line end is omitted: an interrupted run may leave one."""
        try:
            whole, _, _ = path.read_text(encoding="utf-8").rpartition("\n")
        except OSError as error:
            raise RecordError(path, f"can't be read: {error.strerror}") from error
        header, _, rows = whole.partition("\n")
        names = header.split(",")
        if not rows:
            raise RecordError(path, "has no rows")
        try:
            # An empty field stands for no value.
            numbers = np.loadtxt(io.StringIO(rows), delimiter=",", ndmin=2, converters=_number)
        except ValueError as error:
            raise RecordError(path, f"is not a table of numbers: {error}") from error
        if numbers.shape[1] != len(names):
            raise RecordError(path, f"has {numbers.shape[1]} fields in a row, its header has {len(names)}")
        return cls({name: np.ascontiguousarray(column) for name, column in zip(names, numbers.T, strict=True)})

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Return a column; `UnknownColumnError` names similar ones."""
        if name not in self._columns:
            raise UnknownColumnError(name, list(self._columns))
        return self._columns[name]

    def __contains__(self, name: object) -> bool:
        """Whether there is a column of this name."""
        return name in self._columns

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the columns."""
        return iter(self._columns)

    def __len__(self) -> int:
        """Return the number of columns."""
        return len(self._columns)
