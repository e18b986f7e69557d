"""A drive: a state machine without I/O, and the loop that runs it on a link."""

from lashloop.drive.background import BackgroundDrive
from lashloop.drive.parameters import Parameters
from lashloop.drive.serve import serve
from lashloop.drive.state_machine import Drive

__all__ = ["BackgroundDrive", "Drive", "Parameters", "serve"]
