"""Sequences: the control periods since the start, modulo 2^16. Both sides count further for themselves."""

from __future__ import annotations

SEQUENCES = 2**16
LONGEST_GAP = 1000
"""Control periods after the last sample taken beyond which no drive takes another, section 7 of `docs/protocol.md`."""


def of_step(step: int) -> int:
    """Give the sequence of a control period, counted from 0 at the start."""
    return step % SEQUENCES


def nearest_step(sequence: int, step: int) -> int | None:
    """Give the control period nearest to `step` that has this sequence; None if that is before the start."""
    ahead = (sequence - step + SEQUENCES // 2) % SEQUENCES - SEQUENCES // 2
    return step + ahead if step + ahead >= 0 else None
