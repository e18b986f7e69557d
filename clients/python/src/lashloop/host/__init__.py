"""The host's side of the protocol."""

from lashloop.host.at_step import AtStep, FaultAtStep, TelemetryAtStep
from lashloop.host.captured import Captured
from lashloop.host.client import Host
from lashloop.host.description import Parameter, Signal
from lashloop.host.errors import (
    CountError,
    DescriptionError,
    DriveFaultError,
    GapTooLongError,
    HostError,
    ParameterRangeError,
    ParameterRejectedError,
    RejectedError,
    SilenceError,
    StartTooFarError,
    UnknownParameterError,
    UnknownSignalError,
    VersionError,
)
from lashloop.host.line import TimeLimits

__all__ = [
    "AtStep",
    "Captured",
    "CountError",
    "DescriptionError",
    "DriveFaultError",
    "FaultAtStep",
    "GapTooLongError",
    "Host",
    "HostError",
    "Parameter",
    "ParameterRangeError",
    "ParameterRejectedError",
    "RejectedError",
    "Signal",
    "SilenceError",
    "StartTooFarError",
    "TelemetryAtStep",
    "TimeLimits",
    "UnknownParameterError",
    "UnknownSignalError",
    "VersionError",
]
