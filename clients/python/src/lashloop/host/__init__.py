"""The host's side of a conversation with a drive."""

from lashloop.host.client import Host
from lashloop.host.conversation import TimeLimits
from lashloop.host.errors import (
    DriveFaultError,
    GapTooLongError,
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
from lashloop.host.placed import Placed, PlacedFault

__all__ = [
    "DriveFaultError",
    "GapTooLongError",
    "Host",
    "HostError",
    "Parameter",
    "ParameterRangeError",
    "ParameterRefusedError",
    "Placed",
    "PlacedFault",
    "RefusedError",
    "SilenceError",
    "StartTooFarError",
    "TimeLimits",
    "UnknownParameterError",
    "VersionError",
]
