"""The examples of the README work as described."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

from lashloop.host import Host
from support import PATIENT, SOON_S, Program, python_drive

BLOCKS = re.findall(
    r"```python\n(.*?)```", (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8"), flags=re.DOTALL
)


def test_the_host_of_the_readme_gets_a_torque_from_a_drive() -> None:
    with python_drive() as program:
        example = BLOCKS[0].replace("/dev/ttyACM0", program.path)
        ended = subprocess.run(
            [sys.executable, "-c", example], capture_output=True, text=True, timeout=SOON_S, check=True
        )
    assert ended.stdout.splitlines()[0] == "python 0.1.0"
    torque_nm, report = ended.stdout.splitlines()[1].split(maxsplit=1)
    assert float(torque_nm) == pytest.approx(-13 * math.pi / 2, abs=1e-3)
    assert report == "LineReport(messages=2, damaged=0, refused=0, overruns=0)"


def test_the_drive_of_the_readme_runs_its_own_law(tmp_path: Path) -> None:
    example = tmp_path / "mine.py"
    example.write_text(BLOCKS[1], encoding="utf-8")
    with Program([sys.executable, example]) as program, Host.open(program.path, limits=PATIENT) as host:
        assert host.identity.board == "mine"
        host.set("gain_nm_rad", 10.0)
        host.set("watchdog_us", 5_000_000)
        host.arm()
        host.start()
        # A 131,072nd of a turn for each count, 10 N m for each radian.
        torque_nm = host.torque(motor_counts=0, load_counts=-1000, reference_rad=0.0)
        assert torque_nm == pytest.approx(10.0 * 1000 * math.tau / 131_072, rel=1e-6)
