"""The host's side of the protocol."""

from lashloop.host.at_step import AtStep, FaultAtStep
from lashloop.host.client import Host
from lashloop.host.errors import (
    DriveFaultError,
    GapTooLongError,
    HostError,
    ParameterRangeError,
    ParameterRejectedError,
    RejectedError,
    SilenceError,
    StartTooFarError,
    UnknownParameterError,
    VersionError,
)
from lashloop.host.line import TimeLimits
from lashloop.host.parameters import Parameter

__all__ = [
    "AtStep",
    "DriveFaultError",
    "FaultAtStep",
    "GapTooLongError",
    "Host",
    "HostError",
    "Parameter",
    "ParameterRangeError",
    "ParameterRejectedError",
    "RejectedError",
    "SilenceError",
    "StartTooFarError",
    "TimeLimits",
    "UnknownParameterError",
    "VersionError",
]
