"""Everything this package raises on purpose, below one class.

An error says which side it happened on, which value, which limit, and what to do where something can be done.
"""

from __future__ import annotations


class LashloopError(Exception):
    """Base of all errors of this package."""


class FieldError(LashloopError, ValueError):
    """A value that its field on the wire can't hold."""

    def __init__(self, message: str, field: str, value: object, allowed: str) -> None:
        """Name the field, the value and what is allowed."""
        super().__init__(f"{message}.{field} is {value!r}, allowed is {allowed}")
        self.message, self.field, self.value, self.allowed = message, field, value, allowed
