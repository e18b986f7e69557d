"""The examples of the README work as described."""

from __future__ import annotations

import json
import math
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from lashloop import Record
from lashloop.program import VARIABLE
from support import SOON_S, WORKSPACE, program, python_drive

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
RUN, HOST, DRIVE = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
SHELL = re.findall(r"```sh\n(.*?)```", README, flags=re.DOTALL)


# The first figure of a new environment builds the cache of fonts, with little of a busy machine.
FIRST_FIGURE_S = 4 * SOON_S


def python(code: str, folder: Path) -> list[str]:
    """Lines that a program prints, run in a folder with the scenarios."""
    (folder / "scenarios").symlink_to(WORKSPACE / "scenarios")
    environment = {VARIABLE: str(program()), "PATH": "/usr/bin:/bin", "MPLBACKEND": "Agg"}
    words = [sys.executable, "-c", code]
    ended = subprocess.run(
        words, capture_output=True, text=True, timeout=FIRST_FIGURE_S, check=True, cwd=folder, env=environment
    )
    return ended.stdout.splitlines()


def test_the_run_of_the_readme_gives_numbers_and_a_figure(tmp_path: Path) -> None:
    first, second = python(RUN, tmp_path)
    verdict, static_error_rad = first.split()
    assert verdict == "PASS"
    assert abs(float(static_error_rad)) < 0.01
    largest, unit = second.split()
    assert float(largest) < 0.01
    assert unit == "rad"
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


def test_the_host_of_the_readme_gets_a_torque_from_a_drive(tmp_path: Path) -> None:
    with python_drive() as drive:
        lines = python(HOST.replace("/dev/ttyACM0", drive.path), tmp_path)
    assert lines[0] == "python 0.1.0"
    assert lines[1].startswith("pd with ")
    torque_nm, report = lines[2].split(maxsplit=1)
    assert float(torque_nm) == pytest.approx(-13 * math.pi / 2, abs=1e-3)
    assert re.fullmatch(r"LineReport\(messages=2, damaged=0, refused=0, overruns=0, device_time_us=\d+\)", report)
    load_error_rad, unit = lines[3].split()
    assert float(load_error_rad) == pytest.approx(math.pi / 2, abs=1e-4)
    assert unit == "rad"


def commands(block: str) -> list[list[str]]:
    """The commands of a block, as words."""
    return [shlex.split(line, comments=True) for line in block.replace("\\\n", " ").splitlines()]


def test_the_drive_of_the_readme_runs_its_own_law_on_the_bench(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(DRIVE, encoding="utf-8")
    (tmp_path / "scenarios").symlink_to(WORKSPACE / "scenarios")
    (block,) = (it for it in SHELL if "mine.py" in it)
    run, conformance = commands(block.replace("exec:python", f"exec:{sys.executable}"))
    run += ["--out", "out", "--set", "telemetry.every_steps=1"]
    judged = subprocess.run(
        [str(program()), *run[1:]], capture_output=True, text=True, timeout=SOON_S, check=False, cwd=tmp_path
    )
    # The law is too simple for the scenario, but the run has a verdict. A busy machine prints progress.
    complaints = [line for line in judged.stderr.splitlines() if not line.startswith("progress")]
    assert (judged.returncode, complaints) == (1, [])
    record = Record.read(tmp_path / "out")
    # 2 N m for each radian.
    assert record["torque_nm"] == pytest.approx(-2.0 * record["drive.load_error_rad"], rel=1e-6)
    ended = subprocess.run(
        [str(program()), *conformance[1:]], capture_output=True, text=True, timeout=SOON_S, check=False, cwd=tmp_path
    )
    assert (ended.returncode, ended.stderr) == (0, ""), ended.stdout
    assert " passed, 0 failed, 0 not judged, " in ended.stdout, ended.stdout


def test_the_commands_of_the_readme_work() -> None:
    (block,) = (it for it in SHELL if "python -m lashloop identify" in it)
    ended = []
    with python_drive() as drive:
        for words in commands(block.replace("/dev/ttyACM0", drive.path)):
            assert words[:3] == ["python", "-m", "lashloop"]
            if words[3] == "drive":
                words = ["", *words[1:4], "--help"]
            ended.append(
                subprocess.run(
                    [sys.executable, *words[1:]], capture_output=True, text=True, timeout=SOON_S, check=False
                )
            )
    assert [it.returncode for it in ended] == [0] * len(ended)
    assert len(ended) == 7


def test_the_notebook_of_the_readme_is_one() -> None:
    (link,) = re.findall(r"\((examples/[^)]*\.ipynb)\)", README)
    assert json.loads((Path(__file__).parents[1] / link).read_text(encoding="utf-8"))["nbformat"] == 4
