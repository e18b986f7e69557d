"""Encoder counters: they wrap at 32 bits, as often as they like."""

from __future__ import annotations

_HALF = 2**31


def wrapped(counts: int) -> int:
    """Give what a counter of 32 bits shows."""
    return (counts + _HALF) % (2 * _HALF) - _HALF


def wrapping_difference(now: int, before: int) -> int:
    """How far a counter has moved, if that was less than half its range."""
    return wrapped(now - before)
