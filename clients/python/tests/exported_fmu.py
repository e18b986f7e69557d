"""FMUs that `lashloop fmu export` writes, loaded by FMPy, and a master that couples two of them."""

from __future__ import annotations

import hashlib
import json
import shutil
import struct
import subprocess
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from support import WORKSPACE, program

if TYPE_CHECKING:
    from pathlib import Path
    from types import TracebackType

SCENARIOS = WORKSPACE / "scenarios"


def _settings(changes: list[str]) -> list[str]:
    return [word for change in changes for word in ("--set", change)]


def export(scenario: str, part: str, fmi: str, folder: Path, changes: list[str] | None = None) -> Path:
    """The FMU of a part of a scenario."""
    file = folder / f"{part}{fmi}.fmu"
    words: list[str | Path] = [
        "fmu",
        "export",
        SCENARIOS / scenario,
        "--of",
        part,
        "--fmi",
        fmi,
        "--out",
        file,
        *_settings(changes or []),
    ]
    subprocess.run([program(), *words], check=True, capture_output=True)
    return file


def torques_of_run(scenario: Path | str, changes: list[str]) -> str:
    """`torque_sha256` of a run in lockstep, whatever its verdict."""
    words: list[str | Path] = ["run", SCENARIOS / scenario, "--device", "inproc", "--json", *_settings(changes)]
    ended = subprocess.run([program(), *words], check=False, capture_output=True, text=True)
    assert ended.returncode in (0, 1), ended.stderr
    return str(json.loads(ended.stdout)["torque_sha256"])


@dataclass
class Fmu:
    """An instance of an FMU, unpacked into this folder or into one of its own. FMPy unloads the library at the end."""

    file: Path
    start: dict[str, Any] = field(default_factory=dict)
    start_s: float = 0.0
    unpacked: str | None = None

    def __enter__(self) -> Fmu:
        """Loads and initializes it."""
        self.about = read_model_description(str(self.file))
        self.variables = {variable.name: variable for variable in self.about.modelVariables}
        self.folder = self.unpacked or extract(str(self.file))
        is_two = self.about.fmiVersion == "2.0"
        identifier = self.about.coSimulation.modelIdentifier
        kind = FMU2Slave if is_two else FMU3Slave
        guid = self.about.guid if is_two else self.about.instantiationToken
        self.fmu = kind(guid=guid, unzipDirectory=self.folder, modelIdentifier=identifier, instanceName=self.file.stem)
        self.fmu.instantiate()
        self.initialize()
        return self

    def initialize(self) -> None:
        """Sets the start values and goes through the initialization."""
        is_two = self.about.fmiVersion == "2.0"
        if is_two:
            self.fmu.setupExperiment(startTime=self.start_s)
        for name, value in self.start.items():
            self.set(name, value)
        if is_two:
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=self.start_s)
        self.fmu.exitInitializationMode()

    def __exit__(self, kind: type[BaseException] | None, _: BaseException | None, __: TracebackType | None) -> None:
        """Ends the simulation and frees the instance."""
        if kind is None:
            self.fmu.terminate()
        self.fmu.freeInstance()
        if self.unpacked is None:
            shutil.rmtree(self.folder)

    def get(self, name: str) -> Any:
        """The value of a variable."""
        variable = self.variables[name]
        return getattr(self.fmu, f"get{variable.type}")([variable.valueReference])[0]

    def set(self, name: str, value: Any) -> None:
        """Sets a variable."""
        variable = self.variables[name]
        getattr(self.fmu, f"set{variable.type}")([variable.valueReference], [value])

    @property
    def period_s(self) -> float:
        """The control period in s."""
        return float(self.about.defaultExperiment.stepSize)

    @property
    def steps(self) -> int:
        """The control periods of the scenario."""
        return round(float(self.about.defaultExperiment.stopTime) / self.period_s)


def torques_of_pair(plant_file: Path, drive_file: Path) -> str:
    """`torque_sha256` of both FMUs under a master that steps the drive first."""
    digest = hashlib.sha256()
    with Fmu(plant_file) as plant, Fmu(drive_file) as drive:
        for step in range(plant.steps):
            time_s = step * plant.period_s
            for counts in ("motor_counts", "load_counts"):
                drive.set(counts, plant.get(counts))
            drive.fmu.doStep(time_s, plant.period_s)
            torque_nm = drive.get("torque_nm")
            digest.update(struct.pack("<f", torque_nm))
            plant.set("torque_nm", torque_nm)
            plant.fmu.doStep(time_s, plant.period_s)
    return digest.hexdigest()
