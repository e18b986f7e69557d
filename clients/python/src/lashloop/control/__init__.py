"""Control laws: what a drive asks for a torque.

A law of your own is a class with `step`, and a `ControlLaw` that tells the drive its number, its parameters and how it
is built from their values. `lashloop.control.cascade` is an example: the law the drive ships with.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from lashloop.errors import LashloopError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from lashloop.drive.parameters import ParameterSpec


@dataclass(frozen=True, slots=True)
class ControlInput:
    """One encoder sample that the drive has found plausible."""

    motor_counts: int
    """Where the motor encoder stands: its count goes on where what is read of it wraps."""
    load_counts: int
    """Where the load encoder stands, likewise."""
    reference_rad: float
    """Where the load is wanted."""
    applied_torque_nm: float
    """Torque the motor was given since the sample before, after the drive's limit."""
    elapsed_periods: int
    """Control periods since the sample before, more than 1 if samples are missing; 1 at the first."""


@dataclass(frozen=True, slots=True)
class ControlOutput:
    """What a law wants, and what it thinks; the latter goes into the telemetry."""

    torque_nm: float
    """Torque before the drive's limit."""
    dead_zone_estimate_rad: float = 0.0
    disturbing_torque_nm: float = 0.0
    load_error_rad: float = 0.0
    motor_error_rad: float = 0.0
    elastic_error_nm: float = 0.0


class Controller(Protocol):
    """A control law at work: a new one for each run, so that it may remember what it likes."""

    def step(self, sample: ControlInput) -> ControlOutput:
        """Take one sample and give the torque wanted now."""


@dataclass(frozen=True)
class ControlLaw:
    """A control law that a drive offers."""

    number: int
    """Value of the parameter `controller` that chooses it, 1 to 15."""
    parameters: tuple[ParameterSpec, ...]
    """Parameters it needs beside those that every drive has."""
    build: Callable[[Mapping[str, float]], Controller]
    """Makes a controller from all parameters by name; raises `InconsistentError` if they don't go together."""


class InconsistentError(LashloopError):
    """Parameters, each in its range, that don't go together."""

    def __init__(self, name: str) -> None:
        """Name the one that does not go with the others, in a few words."""
        super().__init__(f"{name} does not go with the others")
