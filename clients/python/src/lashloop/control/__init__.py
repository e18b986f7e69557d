"""Control laws of a drive.

A custom law is a class with `step`, and a `ControlLaw` with its name, its parameters, its signals and its constructor.
See `lashloop.control.cascade`, the law of the drive in this package.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from lashloop.declarations import ParameterSpec, SignalSpec, choice, f32, signal, u32
from lashloop.errors import LashloopError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = [
    "ControlInput",
    "ControlLaw",
    "ControlOutput",
    "Controller",
    "InconsistentError",
    "LiveController",
    "ParameterSpec",
    "SignalSpec",
    "choice",
    "f32",
    "signal",
    "u32",
]


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
    """Torque of a law, and its signals."""

    torque_nm: float
    """Torque before the torque limit."""
    signals: Mapping[str, float] = field(default_factory=dict)
    """Value of every signal that the law declares, by name."""


class Controller(Protocol):
    """A control law with its state; built anew for each run."""

    def step(self, sample: ControlInput) -> ControlOutput:
        """Process one sample and return the torque for it."""


@runtime_checkable
class LiveController(Controller, Protocol):
    """A controller that takes over live parameters. Without `update` it may read the mapping at each step."""

    def update(self, parameters: Mapping[str, float]) -> None:
        """Take over all values after a live parameter was set; they are in force from the next sample.

        Called while armed or running, with all parameters by name. `InconsistentError` before anything is taken over
        refuses the new value: the old one stays in force.
        """


@dataclass(frozen=True, kw_only=True)
class ControlLaw:
    """A control law that a drive offers."""

    name: str
    """Name in scenarios and records, at most 28 bytes; lower case with hyphens by convention."""
    parameters: tuple[ParameterSpec, ...] = ()
    """Parameters of the law, in addition to those of every drive."""
    signals: tuple[SignalSpec, ...] = ()
    """Signals of the law, in addition to those of every drive."""
    build: Callable[[Mapping[str, float]], Controller]
    """Builds a controller from all parameters by name; raises `InconsistentError` if they contradict each other.

    The mapping gives the values in force: a law that declares a live parameter has `update`, see `LiveController`, or
    reads the mapping at each step.
    """


class InconsistentError(LashloopError):
    """Parameters, each within its range, that contradict each other."""

    def __init__(self, name: str) -> None:
        """Name the parameter, as the drive declares it: the host gets its index."""
        super().__init__(f"{name} does not go with the other parameters")
        self.name = name
