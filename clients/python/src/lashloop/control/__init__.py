"""Control laws of a drive.

A custom law is a class with `step`, and a `ControlLaw` with its number, its parameters and its constructor. See
`lashloop.control.cascade`, the law of the drive in this package.
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
    """One encoder sample that passed the plausibility check of the drive."""

    motor_counts: int
    """Position of the motor encoder, without wraparound."""
    load_counts: int
    """Position of the load encoder, without wraparound."""
    reference_rad: float
    """Reference position of the load."""
    applied_torque_nm: float
    """Torque applied since the previous sample, after the torque limit."""
    elapsed_periods: int
    """Control periods since the previous sample: more than 1 if samples are missing, 1 at the first sample."""


@dataclass(frozen=True, slots=True)
class ControlOutput:
    """Torque of a law, and the signals for its telemetry."""

    torque_nm: float
    """Torque before the torque limit."""
    dead_zone_estimate_rad: float = 0.0
    disturbing_torque_nm: float = 0.0
    load_error_rad: float = 0.0
    motor_error_rad: float = 0.0
    elastic_error_nm: float = 0.0


class Controller(Protocol):
    """A control law with its state; built anew for each run."""

    def step(self, sample: ControlInput) -> ControlOutput:
        """Process one sample and return the torque for it."""


@dataclass(frozen=True)
class ControlLaw:
    """A control law that a drive offers."""

    number: int
    """Value of the parameter `controller` that selects the law, 1 to 15."""
    parameters: tuple[ParameterSpec, ...]
    """Parameters of the law, in addition to those of every drive."""
    build: Callable[[Mapping[str, float]], Controller]
    """Builds a controller from all parameters by name; raises `InconsistentError` if they contradict each other."""


class InconsistentError(LashloopError):
    """Parameters, each within its range, that contradict each other."""

    def __init__(self, name: str) -> None:
        """Name the parameter."""
        super().__init__(f"{name} does not go with the others")
