"""`python -m lashloop.fmu`: FMUs for model exchange and of FMI 1.0, one C file as each, against its co-simulation."""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest

from lashloop import fmu

DATA = Path(__file__).parents[3] / "tests/data/fmu"
SETTINGS: dict[str, Any] = {
    "torque_input": "torque",
    "motor_output": "motor.phi",
    "load_output": "load.phi",
    "signals": ["twist"],
    "start": {"motor.start": 1.5, "load.start": 0.5, "substeps": 64.0},
}


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("library") / "plant.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", path, DATA / "plant.c", "-lm"], check=True)
    return path


def pack(folder: Path, library: Path, description: str, without: str) -> dict[str, Any]:
    xml = (DATA / f"{description}.xml").read_text()
    with zipfile.ZipFile(folder / "plant.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", re.sub(f"<{without}.*\\n", "", xml))
        archive.write(library, "binaries/linux64/plant.so")
    return SETTINGS | {"file": str(folder / "plant.fmu")}


def serve(settings: dict[str, Any], steps: int = 200) -> list[dict[str, Any]]:
    """The answers to steps of 1 ms."""
    hello = {"lashloop_plant": 1, "period_s": 1e-3, "settings": settings}
    held = [{"torque_nm": 1.5 if k < 100 else -1.0, "dt_s": 1e-3} for k in range(steps)]
    output = io.StringIO()
    fmu.serve(io.StringIO("\n".join(map(json.dumps, [hello, *held]))), output)
    return [json.loads(line) for line in output.getvalue().splitlines()]


@pytest.mark.parametrize(
    ("description", "without"),
    [("two", "CoSimulation"), ("one", "Implementation"), ("one", "NoElement")],
    ids=["model exchange of 2.0", "model exchange of 1.0", "co-simulation of 1.0"],
)
def test_every_kind_moves_as_the_plant_does(tmp_path: Path, library: Path, description: str, without: str) -> None:
    answers = serve(pack(tmp_path, library, description, without))
    assert answers[0]["signals"] == [{"name": "twist", "unit": "rad"}]
    assert (answers[0]["motor_position_rad"], answers[0]["load_position_rad"]) == (1.5, 0.5)
    (tmp_path / "one").mkdir()
    reference = serve(pack(tmp_path / "one", library, "one", "NoElement"))
    assert len(answers) == len(reference) == 201
    for have, want in zip(answers, reference, strict=True):
        for position in ("motor_position_rad", "load_position_rad"):
            assert have[position] == pytest.approx(want[position], abs=1e-5)
    assert answers == serve(pack(tmp_path, library, description, without)), "the same bits again"


def test_what_is_missing_is_named(tmp_path: Path, library: Path) -> None:
    exchange = pack(tmp_path, library, "two", "CoSimulation")
    changes: list[tuple[dict[str, Any], str]] = [
        ({"load_output": "load.ph"}, "no variable 'load.ph', which plant.load_output names; it has load.phi"),
        ({"motor_output": "stiffness"}, "has the unit N.m/rad; plant.motor_output needs rad"),
        ({"torque_input": "motor_torque"}, "no variable 'motor_torque', which plant.torque_input names"),
        ({"start": {"torque": 1.0}}, "plant.start.torque is the torque input, which the bench sets"),
        ({"start": {"mode": 12, "stiffness": 2.0}}, "'stiffness' is nan after its start value of 2.0"),
        ({"start": {"mode": 9, "stiffness": 2.0}}, "'stiffness' is 1.0 after its start value of 2.0"),
    ]
    for change, want in changes:
        (answer,) = serve(exchange | change)
        assert want in answer["error"]
    (answer,) = serve(pack(tmp_path, library, "two", "ModelExchange"))
    assert answer["error"] == "the FMU is for co-simulation only: lashloop-fmu runs it, without plant.command"


def test_a_model_may_end_the_simulation(tmp_path: Path, library: Path) -> None:
    settings = pack(tmp_path, library, "two", "CoSimulation")
    answers = serve(settings | {"start": SETTINGS["start"] | {"mode": 8}})
    assert len(answers) == 4
    assert re.match(r"the FMU ends the simulation at t = 0\.00[23]", answers[-1]["error"])


def test_the_end_of_the_lines_ends_the_fmu(tmp_path: Path, library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fmi2 = pytest.importorskip("fmpy.fmi2")
    calls: list[str] = []
    for name in ("terminate", "freeInstance"):
        monkeypatch.setattr(fmi2.FMU2Model, name, lambda _, name=name: calls.append(name))
    serve(pack(tmp_path, library, "two", "CoSimulation"), steps=1)
    assert calls == ["terminate", "freeInstance"]


def test_what_the_fmu_prints_is_kept_out_of_the_protocol(tmp_path: Path, library: Path) -> None:
    settings = pack(tmp_path, library, "one", "NoElement")
    hello = json.dumps({"lashloop_plant": 1, "period_s": 1e-3, "settings": settings})
    ended = subprocess.run(
        [sys.executable, "-m", "lashloop.fmu"], input=hello + "\n", capture_output=True, text=True, check=True
    )
    assert json.loads(ended.stdout)["lashloop_plant"] == 1
