"""The `lashloop` program: where it is."""

from __future__ import annotations

import os
import shutil
import sysconfig
from pathlib import Path
from typing import TYPE_CHECKING

from lashloop.errors import LashloopError

if TYPE_CHECKING:
    from collections.abc import Iterator

VARIABLE = "LASHLOOP_BIN"
"""Environment variable with the path of the program."""
_NAME = "lashloop"


class ProgramNotFoundError(LashloopError):
    """The program is not installed, not built, or not where `LASHLOOP_BIN` names it."""


def find_program() -> Path:
    """Return the path of the program.

    In this order: `LASHLOOP_BIN`; the one that a wheel installed next to this Python; `PATH`; the newest build in a
    `target` folder of the working folder, a folder above it, or of the checkout from which this package is installed in
    editable mode.
    """
    named = os.environ.get(VARIABLE)
    if named:
        if not Path(named).is_file():
            raise ProgramNotFoundError(f"{VARIABLE} is {named}, which isn't a file: correct it, or unset it")
        return Path(named)
    scripts = sysconfig.get_path("scripts")
    installed = shutil.which(_NAME, path=scripts) or shutil.which(_NAME)
    if installed:
        return Path(installed)
    built = [path for folder in _target_folders() for path in _builds(folder) if path.is_file()]
    if not built:
        raise ProgramNotFoundError(
            f"there is no program {_NAME}: build it with `cargo build --release -p lashloop-cli` in a checkout, take "
            f"the wheel that has it, put one into PATH, or name it in {VARIABLE}"
        )
    return max(built, key=lambda path: path.stat().st_mtime)


def _target_folders() -> Iterator[Path]:
    if "CARGO_TARGET_DIR" in os.environ:
        yield Path(os.environ["CARGO_TARGET_DIR"])
    here = Path.cwd()
    yield from (folder / "target" for folder in (here, *here.parents, *Path(__file__).parents))


def _builds(target: Path) -> Iterator[Path]:
    return (target / profile / _NAME for profile in ("release", "debug"))
