"""A drive on a line: reads, answers, and looks at the watchdog in time."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from lashloop.drive.answers import fault_frame
from lashloop.lines import LineError

if TYPE_CHECKING:
    from lashloop.drive.machine import Drive
    from lashloop.lines import Line

_LONGEST_WAIT_S = 60.0
"""While nothing can trip there is nothing to look at, so any time does."""


def serve(line: Line, drive: Drive) -> None:
    """Run a drive until the line breaks, which is a `LineError`.

    Sending does not hold it: a host that does not read can't keep the watchdog from tripping. An exception, of a
    controller perhaps, takes the torque away with the drive and is told to the host as a panic before it is raised.
    """
    unsent = b""
    try:
        while True:
            left_s = drive.time_left_s
            wait_s = _LONGEST_WAIT_S if left_s is None else left_s
            # What was asked is answered before anything else is read, so the answers can't pile up.
            unsent = unsent[line.write(unsent, wait_s) :] if unsent else drive.receive(line.read(wait_s))
            unsent += drive.tick()
    except LineError:
        raise
    except Exception as error:
        with contextlib.suppress(LineError):
            line.write(fault_frame(_source_line(error)), 0.0)
        raise


def _source_line(error: Exception) -> int:
    traceback = error.__traceback__
    while traceback is not None and traceback.tb_next is not None:
        traceback = traceback.tb_next
    return traceback.tb_lineno if traceback else 0
