"""The base class of all errors of this package.

An error names the side, the value, the limit and, where possible, the remedy.
"""

from __future__ import annotations


class LashloopError(Exception):
    """Base of all errors of this package."""


class FieldError(LashloopError, ValueError):
    """A value outside the range of its field on the wire."""

    def __init__(self, message: str, field: str, value: object, allowed: str) -> None:
        """Name the field, the value and the range."""
        super().__init__(f"{message}.{field} is {value!r}, allowed is {allowed}")
        self.message, self.field, self.value, self.allowed = message, field, value, allowed
