"""Encoder readings: they are 24 bits of a count and wrap, as often as they like."""

from __future__ import annotations

_HALF = 2**23
LARGEST = _HALF - 1
"""The largest reading; one count further is the smallest, -2^23."""


def wrapped(counts: int) -> int:
    """Give what is read of an encoder that stands at `counts`."""
    return (counts + _HALF) % (2 * _HALF) - _HALF


def wrapping_difference(now: int, before: int) -> int:
    """How far an encoder has moved between two readings, if that was less than half their range."""
    return wrapped(now - before)
