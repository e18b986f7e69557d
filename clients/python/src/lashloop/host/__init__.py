"""The host's side of a conversation with a drive."""

from lashloop.host.client import Host
from lashloop.host.conversation import TimeLimits
from lashloop.host.errors import (
    DriveFaultError,
    HostError,
    ParameterRangeError,
    ParameterRefusedError,
    RefusedError,
    SilenceError,
    StartTooFarError,
    UnknownParameterError,
    VersionError,
)
from lashloop.host.parameters import Parameter

__all__ = [
    "DriveFaultError",
    "Host",
    "HostError",
    "Parameter",
    "ParameterRangeError",
    "ParameterRefusedError",
    "RefusedError",
    "SilenceError",
    "StartTooFarError",
    "TimeLimits",
    "UnknownParameterError",
    "VersionError",
]
