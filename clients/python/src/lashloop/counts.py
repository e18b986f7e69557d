"""Encoder readings: 24 bits of a count, with wraparound."""

from __future__ import annotations

_HALF = 2**23
LARGEST = _HALF - 1
"""The largest reading; the next count reads as the smallest, -2^23."""


def wrapped(counts: int) -> int:
    """Return the reading of an encoder at position `counts`."""
    return (counts + _HALF) % (2 * _HALF) - _HALF


def wrapping_difference(now: int, before: int) -> int:
    """Travel of an encoder between two readings, if less than half the range."""
    return wrapped(now - before)
