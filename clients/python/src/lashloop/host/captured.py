"""A capture that a host has read."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Captured:
    """Rows of a capture, in the order of the control steps."""

    signals: tuple[str, ...]
    """Names of the values of a row, in their order."""
    every: int
    """Control steps from one row to the next."""
    event: int
    """Number of the first row at or after the event; the number of rows if none is."""
    rows: tuple[tuple[float, ...], ...]

    def __getitem__(self, signal: str) -> tuple[float, ...]:
        """Return the values of a signal; `KeyError` if the capture does not have it."""
        if signal not in self.signals:
            raise KeyError(signal)
        place = self.signals.index(signal)
        return tuple(row[place] for row in self.rows)
