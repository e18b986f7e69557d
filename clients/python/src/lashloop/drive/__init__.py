"""The drive: what a host talks to. A state machine without I/O, and what runs it on a line."""

from lashloop.drive.machine import Drive
from lashloop.drive.parameters import Parameters, ParameterSpec
from lashloop.drive.serve import serve

__all__ = ["Drive", "ParameterSpec", "Parameters", "serve"]
