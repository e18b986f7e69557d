"""Sequence numbers: the control periods since the start, modulo 2^16."""

from __future__ import annotations

SEQUENCES = 2**16
LONGEST_GAP = 1000
"""Longest gap between two samples that a drive accepts, in control periods, section 7 of `docs/protocol.md`."""


def of_step(step: int) -> int:
    """Return the sequence of a control period, counted from 0 at the start."""
    return step % SEQUENCES


def nearest_step(sequence: int, step: int) -> int | None:
    """Return the control period nearest to `step` with this sequence; None if it precedes the start."""
    ahead = (sequence - step + SEQUENCES // 2) % SEQUENCES - SEQUENCES // 2
    return step + ahead if step + ahead >= 0 else None
