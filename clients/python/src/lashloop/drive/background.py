"""A drive in this process, on a pseudo-terminal, for hosts in other processes."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from lashloop.drive.serve import serve
from lashloop.link import LinkError, PseudoTerminal

if TYPE_CHECKING:
    from types import TracebackType

    from typing_extensions import Self

    from lashloop.drive.state_machine import Drive


class BackgroundDrive:
    """A drive, served by a thread within a `with` block. `path` is the terminal for the host."""

    def __init__(self, drive: Drive) -> None:
        """Open the pseudo-terminal and start the thread."""
        self.drive = drive
        self.error: Exception | None = None
        """The error that has ended the drive before the end of the block, of a control law for example."""
        self._line = PseudoTerminal()
        self.path = self._line.path
        # A daemon, so that an interpreter that ends without leaving the block does not wait for the drive.
        self._thread = threading.Thread(target=self._serve, name=f"drive on {self.path}", daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        try:
            serve(self._line, self.drive)
        except LinkError:
            # The end of the block.
            return
        except Exception as error:
            self.error = error

    def __enter__(self) -> Self:
        """Return the drive itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the drive."""
        self._line.hang_up()
        self._thread.join()
        self._line.close()
