"""The loop of a drive on a link: receives, answers, and checks the watchdog in time."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from lashloop.link import LinkClosedError, LinkError

if TYPE_CHECKING:
    from lashloop.drive.state_machine import Drive
    from lashloop.link import Link

_LONGEST_WAIT_S = 60.0
"""Wait while no watchdog can trip; the value is arbitrary."""


def serve(link: Link, drive: Drive) -> None:
    """Run a drive until its host closes the link; `LinkError` if the link fails.

    Sending never blocks: a host that does not read can't keep the watchdog from tripping. An exception, of a control
    law for example, ends the drive and its torque. The drive reports it to the host as a panic, then raises it.
    """
    unsent = b""
    try:
        while True:
            left_s = drive.time_left_s
            wait_s = _LONGEST_WAIT_S if left_s is None else left_s
            # Requests are answered before the next read, so that answers can't accumulate.
            unsent = unsent[link.write(unsent, wait_s) :] if unsent else drive.receive(link.read(wait_s))
            unsent += drive.tick()
    except LinkClosedError:
        return
    except LinkError:
        raise
    except Exception as error:
        with contextlib.suppress(LinkError):
            link.write(drive.halt(_source_line(error)), 0.0)
        raise


def _source_line(error: Exception) -> int:
    traceback = error.__traceback__
    while traceback is not None and traceback.tb_next is not None:
        traceback = traceback.tb_next
    return traceback.tb_lineno if traceback else 0
