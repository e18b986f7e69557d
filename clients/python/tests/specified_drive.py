"""The drive of the specification's example: its tables, and another drive with equal names in its place."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from lashloop.messages import Identity, ParameterReport, SetParameter, Subscribe, Telemetry
from support import table

if TYPE_CHECKING:
    from lashloop.drive import Drive
    from lashloop.messages import DriveMessage, HostMessage

LAWS, PARAMETERS, SIGNALS = "### Laws", "### Parameters", "### Signals"
"""Headings of its tables, section 16. The first columns are index and name."""


class Translation:
    """Indices of the specified drive to those of ours, by name, and back. Indices are up to a drive."""

    def __init__(self, drive: Drive) -> None:
        """Read the tables of both."""
        self._parameters = _indices(PARAMETERS, [spec.name for spec in drive.parameters.specs])
        self._signals = _indices(SIGNALS, drive.signals)
        self._subscribed: list[int] = []
        """Signals of the specified drive in the order of our telemetry."""

    def request(self, message: HostMessage) -> HostMessage:
        """Translate a request of the example for our drive."""
        match message:
            case SetParameter():
                return replace(message, index=self._parameters[message.index])
            case Subscribe():
                theirs = [it for it in self._signals if message.signals >> it & 1]
                self._subscribed = sorted(theirs, key=lambda it: self._signals[it])
                return replace(message, signals=sum(1 << self._signals[it] for it in theirs))
            case _:
                return message

    def answer(self, message: DriveMessage) -> DriveMessage:
        """Translate an answer of our drive for the example."""
        match message:
            case ParameterReport():
                (index,) = (their for their, our in self._parameters.items() if our == message.index)
                return replace(message, index=index)
            case Telemetry():
                values = sorted(zip(self._subscribed, message.values, strict=True))
                return replace(message, values=tuple(value for _, value in values))
            case Identity():
                counts = (len(table(LAWS)), len(table(SIGNALS)), len(table(PARAMETERS)))
                return replace(message, law_count=counts[0], signal_count=counts[1], parameter_count=counts[2])
            case _:
                return message


def _indices(heading: str, ours: list[str]) -> dict[int, int]:
    """Indices of the specified drive to ours, of the names that both have."""
    return {int(row[0]): ours.index(row[1]) for row in table(heading) if row[1] in ours}
