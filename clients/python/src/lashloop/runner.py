"""`run`: a scenario on a drive, by the `lashloop` program, and its record as arrays.

```python
import lashloop

record = lashloop.run("scenarios/smooth-after.toml", set={"plant.dead_zone_rad": 0.2}, device="native")
print(record.verdict, record.metrics["settle_time_s"])
error_rad = record["load_position_rad"] - record["reference_rad"]
record.plot("load_position_rad", "reference_rad", "torque_nm")
```
"""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from lashloop.drive import BackgroundDrive, Drive
from lashloop.errors import LashloopError
from lashloop.program import find_program
from lashloop.record import Record

_JUDGED = (0, 1, 3)
"""Exit codes with a verdict: PASS, FAIL, INVALID."""
_USAGE, _DEVICE = 2, 4
_GRACE_S = 5.0
"""For the program to end its drive and close its files after SIGTERM."""


class ProgramError(LashloopError):
    """The program made no run. The text of the error is that of the program."""

    def __init__(self, code: int, text: str) -> None:
        """Keep the exit code and the text."""
        super().__init__(text or f"the program ended with the exit code {code} and no text")
        self.code, self.text = code, text


class ScenarioError(ProgramError):
    """The scenario or one of its settings is wrong. No run was made."""


class DeviceError(ProgramError):
    """The drive or its link has failed. The run has no verdict."""


class RunTimeoutError(LashloopError):
    """The run took longer than the limit; it was ended."""

    def __init__(self, scenario: str, limit_s: float) -> None:
        """Name the scenario and the limit."""
        super().__init__(f"the run of {scenario} took more than {limit_s:g} s and was ended: raise timeout_s")
        self.scenario, self.limit_s = scenario, limit_s


def run(
    scenario: str | os.PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,  # noqa: A002 - the option of the program has this name
    device: str | Drive | None = None,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
    program: str | os.PathLike[str] | None = None,
    timeout_s: float | None = None,
) -> Record:
    """Run a scenario and return its record. FAIL and INVALID are verdicts of the record, not errors.

    `set` replaces values of the scenario by key: `{"plant.dead_zone_rad": 0.2, "controller.name": "pd"}`. A value is a
    text, a truth value, a number, a list or a table. `device` is the drive: an option `--device` of the program, or a
    `Drive` of this package, which runs in this process; by default that of the program. `out` is a folder for the
    record, which stays there; without it the record is in memory only. `force` replaces a record that the folder
    holds. `program` is found by `find_program`.
    `timeout_s` limits the run in wall-clock time.

    `ScenarioError` and `DeviceError` have the text of the program. An error of a control law in a `Drive` is raised.
    """
    words = [str(program or find_program()), "run", os.fspath(scenario)]
    for key, value in (set or {}).items():
        words += ["--set", f"{key}={toml(value)}"]
    if force and out is not None:
        words.append("--force")
    if isinstance(device, Drive):
        return _run_on(device, words, out, timeout_s)
    if device is not None:
        words += ["--device", device]
    return _run(words, out, timeout_s)


def _run_on(drive: Drive, words: list[str], out: str | os.PathLike[str] | None, timeout_s: float | None) -> Record:
    background = BackgroundDrive(drive)
    try:
        with background:
            return _run([*words, "--device", background.path], out, timeout_s)
    finally:
        # The cause, instead of the program's report about a drive that has ended.
        if background.error is not None:
            raise background.error


def _run(words: list[str], out: str | os.PathLike[str] | None, timeout_s: float | None) -> Record:
    if out is not None:
        return _recorded(words, Path(out), timeout_s)
    with tempfile.TemporaryDirectory(prefix="lashloop-") as folder:
        # In a folder of its own: the link to the latest record goes next to it.
        return replace(_recorded(words, Path(folder, "record"), timeout_s), folder=None)


def _recorded(words: list[str], out: Path, timeout_s: float | None) -> Record:
    process = subprocess.Popen(
        [*words, "--out", str(out)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
    )
    try:
        _, stderr = process.communicate(timeout=timeout_s)
    except subprocess.TimeoutExpired:
        _end(process)
        raise RunTimeoutError(words[2], timeout_s or 0.0) from None
    except BaseException:
        # An interrupt in a notebook reaches this process only.
        _end(process)
        raise
    if process.returncode in _JUDGED:
        return Record.read(out)
    kind = {_USAGE: ScenarioError, _DEVICE: DeviceError}.get(process.returncode, ProgramError)
    raise kind(process.returncode, stderr.strip().removeprefix(f"{Path(words[0]).name}: "))


def _end(process: subprocess.Popen[str]) -> None:
    """End the program in order, so that it ends its drive and completes its files."""
    process.terminate()
    try:
        process.communicate(timeout=_GRACE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()


def toml(value: Any) -> str:
    """Return a value as TOML; `TypeError` for a type that TOML lacks."""
    match value:
        case np.generic() | np.ndarray():
            return toml(value.tolist())
        case bool():
            return str(value).lower()
        case str():
            # A JSON string is a basic string of TOML, apart from DEL.
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case os.PathLike():
            return toml(os.fspath(value))
        case int():
            return str(value)
        case float():
            # Infinities and NaN have the same names in TOML.
            return repr(value)
        case Mapping():
            return f"{{{', '.join(f'{toml(str(key))} = {toml(it)}' for key, it in value.items())}}}"
        case list() | tuple():
            return f"[{', '.join(map(toml, value))}]"
        case _:
            raise TypeError(f"{value!r} is a {type(value).__name__}, which a scenario can't have")
