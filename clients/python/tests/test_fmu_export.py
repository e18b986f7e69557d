"""`lashloop fmu export` under foreign importers: FMPy, libcosim and our own."""

from __future__ import annotations

import hashlib
import math
import re
import struct
import subprocess
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from fmpy import extract, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from exported_fmu import SCENARIOS, Fmu, export, torques_of_pair, torques_of_run
from support import program

SHAFT = "shaft-pd.toml"
SMOOTH = "smooth-after.toml"
# Everything random and everything late: seeds of both encoders and of the line, a bridge, motor and encoder faults.
LOSSY = [
    "encoders.noise_counts=1.5",
    "line.delay_us=300",
    "line.jitter_us=2500",
    "line.loss=0.05",
    "run.seed=7",
    "run.duration_s=3",
    "run.control_period_us=500",
    "expect=[]",
]
FAULTY = [
    "fault=[{at_s=0.5, for_s=0.2, kind='torque-gain', gain=0.5}, {at_s=0.8, kind='torque-delay', steps=2}, "
    "{at_s=1, for_s=0.3, kind='encoder-noise', side='motor', counts=3}, "
    "{at_s=1.5, kind='gap-growth', growth_rad=0.05}]",
    "run.duration_s=2",
    "expect=[]",
]


@pytest.mark.parametrize("fmi", ["2", "3"])
@pytest.mark.parametrize("part", ["plant", "drive"])
def test_a_description_has_no_problem(tmp_path: Path, part: str, fmi: str) -> None:
    for scenario in ("shaft-bridge.toml", "shaft-triangle.toml"):
        assert validate_fmu(str(export(scenario, part, fmi, tmp_path))) == []


@pytest.mark.parametrize(
    ("fmi", "scenario", "changes"),
    [
        ("2", SMOOTH, ["run.duration_s=5", "expect=[]"]),
        ("3", SHAFT, ["run.duration_s=5", "expect=[]"]),
        ("2", "shaft-bridge.toml", ["run.duration_s=2", "expect=[]"]),
        ("3", "shaft-triangle.toml", ["run.duration_s=3", "expect=[]"]),
        ("2", "shaft-load-step.toml", ["run.duration_s=4", "expect=[]"]),
        ("2", SHAFT, LOSSY),
        ("3", SHAFT, LOSSY),
        ("2", SHAFT, FAULTY),
    ],
    ids=["smooth", "delayed", "bridge", "table", "load", "lossy in 2.0", "lossy in 3.0", "faulty"],
)
def test_a_pair_gives_the_torques_of_a_run_bit_for_bit(
    tmp_path: Path, fmi: str, scenario: str, changes: list[str]
) -> None:
    plant, drive = (export(scenario, part, fmi, tmp_path, changes) for part in ("plant", "drive"))
    assert torques_of_pair(plant, drive) == torques_of_run(scenario, changes)


STRUCTURE = """<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
  <StartTime>0.0</StartTime><BaseStepSize>0.001</BaseStepSize><Algorithm>fixedStep</Algorithm>
  <Simulators><Simulator name="plant" source="{plant}"/><Simulator name="drive" source="{drive}"/></Simulators>
  <Connections>{connections}</Connections>
</OspSystemStructure>"""


def test_libcosim_steps_both_at_once_which_is_one_period_of_delay(tmp_path: Path) -> None:
    # It has wheels for some versions of Python only.
    pytest.importorskip("libcosimpy")
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.ERROR)
    short = ["run.duration_s=3"]
    plant, drive = (export(SHAFT, part, "2", tmp_path, short) for part in ("plant", "drive"))
    connections = "".join(
        f'<VariableConnection><Variable simulator="{a}" name="{name}"/>'
        f'<Variable simulator="{b}" name="{name}"/></VariableConnection>'
        for a, b, name in [
            ("plant", "drive", "motor_counts"),
            ("plant", "drive", "load_counts"),
            ("drive", "plant", "torque_nm"),
        ]
    )
    text = STRUCTURE.format(plant=plant, drive=drive, connections=connections)
    (tmp_path / "OspSystemStructure.xml").write_text(text)
    execution = CosimExecution.from_osp_config_file(str(tmp_path))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    index = execution.slave_index_from_instance_name("drive")
    with Fmu(drive) as about:
        reference = about.variables["torque_nm"].valueReference
    digest = hashlib.sha256()
    for _ in range(3000):
        assert execution.step()
        digest.update(struct.pack("<f", *observer.last_real_values(index, [reference])))
    assert digest.hexdigest() == torques_of_run(SHAFT, [*short, "line.delay_us=1000"])


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_an_exported_plant_imported_again_gives_the_run_of_the_built_in_one(tmp_path: Path, fmi: str) -> None:
    changes = ["run.duration_s=3"]
    plant = export(SMOOTH, "plant", fmi, tmp_path, changes)
    text = (SCENARIOS / SMOOTH).read_text()
    # Without the keys of the smooth plant and its start, which are in the FMU.
    text = re.sub(r"(?ms)^\[plant\]$.*?(?=^\[(?!plant))", "", text)
    section = (
        f'[plant]\nmodel = "fmu"\nfile = "{plant}"\ntorque_input = "torque_nm"\n'
        'motor_output = "motor_position_rad"\nload_output = "load_position_rad"\nstep_timeout_ms = 30000\n'
        f"start_timeout_ms = 30000\n[plant.initial]\nmotor_position_rad = {1.5 * math.pi}\n"
        f"load_position_rad = {0.5 * math.pi}\n"
    )
    scenario = tmp_path / "again.toml"
    scenario.write_text(f"{text}\n{section}")
    assert torques_of_run(scenario, changes) == torques_of_run(SMOOTH, changes)


def trajectory(fmu: Fmu, first: int, last: int) -> list[tuple[Any, ...]]:
    rows = []
    for step in range(first, last):
        fmu.set("torque_nm", math.sin(0.05 * step))
        fmu.fmu.doStep(step * fmu.period_s, fmu.period_s)
        rows.append(tuple(fmu.get(name) for name in ("load_position_rad", "twist_rad", "motor_counts", "load_counts")))
    return rows


@pytest.mark.parametrize("fmi", ["2", "3"])
@pytest.mark.parametrize("scenario", [SMOOTH, SHAFT, "friction-after.toml"])
def test_a_state_continues_bit_for_bit_in_this_instance_and_in_another(tmp_path: Path, scenario: str, fmi: str) -> None:
    changes = ["encoders.noise_counts=1.5", "line.delay_us=1700", "line.jitter_us=800", "line.loss=0.1"]
    file = export(scenario, "plant", fmi, tmp_path, changes)
    start = {"plant.dead_zone_rad": 0.2, "encoders.noise_counts": 2.5}
    with Fmu(file, start) as fmu:
        trajectory(fmu, 0, 300)
        state = fmu.fmu.getFMUState()
        want = trajectory(fmu, 300, 600)
        fmu.fmu.setFMUState(state)
        assert trajectory(fmu, 300, 600) == want
        saved = fmu.fmu.serializeFMUState(state)
        fmu.fmu.freeFMUState(state)
    with Fmu(file) as other:
        trajectory(other, 0, 10)
        state = other.fmu.deserializeFMUState(saved)
        other.fmu.setFMUState(state)
        other.fmu.freeFMUState(state)
        assert other.get("plant.dead_zone_rad") == 0.2
        assert trajectory(other, 300, 600) == want
    foreign = export(scenario, "plant", fmi, tmp_path, [*changes, "run.seed=2"])
    with Fmu(foreign) as fmu:
        state = fmu.fmu.deserializeFMUState(saved)
        with pytest.raises(FMICallException):
            fmu.fmu.setFMUState(state)
        fmu.fmu.freeFMUState(state)


def memory_kib() -> int:
    status = Path("/proc/self/status").read_text()
    found = re.search(r"^VmRSS:\s+(\d+) kB$", status, re.MULTILINE)
    assert found
    return int(found[1])


def thread_count() -> int:
    return len(list(Path("/proc/self/task").iterdir()))


@pytest.mark.parametrize("fmi", ["2", "3"])
@pytest.mark.parametrize("part", ["plant", "drive"])
def test_500_runs_in_one_importer_take_no_more_memory(tmp_path: Path, part: str, fmi: str) -> None:
    file = export(SHAFT, part, fmi, tmp_path)
    folder = extract(str(file))
    memory = []
    threads = thread_count()
    for run in range(251):
        # Each instance makes two runs, and its library is loaded and unloaded.
        with Fmu(file, unpacked=folder) as fmu:
            for again in (False, True):
                if again:
                    fmu.fmu.terminate()
                    fmu.fmu.reset()
                    fmu.initialize()
                for step in range(20):
                    fmu.fmu.doStep(step * fmu.period_s, fmu.period_s)
        if run % 50 == 0:
            memory.append(memory_kib())
    # The allocator takes memory now and then; a leak takes it in every block of runs.
    growth_kib = [after - before for before, after in pairwise(memory)]
    assert min(growth_kib) < 50, f"{growth_kib} KiB, each in 100 runs"
    assert sum(growth_kib[1:]) < 1024, f"{growth_kib} KiB, each in 100 runs"
    assert thread_count() <= threads, "threads that instances have left"


def test_a_plant_takes_any_step_and_a_start_time(tmp_path: Path) -> None:
    file = export(SMOOTH, "plant", "3", tmp_path)
    ends = []
    for step_s in (1e-3, 5e-3, 4e-4, 1e-2 / 3):
        with Fmu(file, {"plant.substeps": 64}, start_s=2.0) as fmu:
            fmu.set("torque_nm", 1.0)
            for step in range(round(0.1 / step_s)):
                fmu.fmu.doStep(2.0 + step * step_s, step_s)
            ends.append((fmu.get("load_position_rad"), fmu.get("motor_counts")))
            assert fmu.get("time") == pytest.approx(2.1, abs=1e-9)
    assert ends[0] == ends[1], "the same periods"
    for position_rad, counts in ends:
        assert position_rad == pytest.approx(ends[0][0], abs=1e-9)
        assert abs(counts - ends[0][1]) <= 1


def test_what_an_fmu_refuses_is_named(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    plant, drive = (export(SHAFT, part, "2", tmp_path) for part in ("plant", "drive"))

    def refused(fmu: Fmu, call: str, *arguments: Any) -> str:
        with pytest.raises(FMICallException):
            getattr(fmu.fmu, call)(*arguments)
        return capfd.readouterr().out

    with Fmu(drive) as fmu:
        text = refused(fmu, "doStep", 0.0, 2e-3)
        assert "a step of 0.002 s at t = 0 s: the drive takes one sample in each control period" in text
        assert "every step must be 0.001 s" in text
        fmu.fmu.doStep(0.0, 1e-3)
        assert "the FMU is at 0.001 s" in refused(fmu, "doStep", 0.0, 1e-3)
        assert "the state of this FMU can't be saved" in refused(fmu, "getFMUState")
        reference = fmu.variables["torque_nm"].valueReference
        assert "(torque_nm) can't be set" in refused(fmu, "setReal", [reference], [1.0])
        assert "(torque_nm) is of type Real, not Integer" in refused(fmu, "getInteger", [reference])
        # As a broken wire: the drive latches a fault.
        fmu.set("motor_counts", 4_000_000)
        assert re.search(r"gives no torque at t = 0.001 s: it latched \w+", refused(fmu, "doStep", 1e-3, 1e-3))
    with Fmu(plant) as fmu:
        assert "so steps must be multiples of it" in refused(fmu, "doStep", 0.0, 5e-4)
        reference = fmu.variables["plant.dead_zone_rad"].valueReference
        assert "parameters are fixed after the initialization" in refused(fmu, "setReal", [reference], [0.3])
    with pytest.raises(FMICallException), Fmu(plant, {"plant.dead_zone_rad": -1.0}):
        pass
    assert "plant.dead_zone_rad" in capfd.readouterr().out


def test_a_drive_follows_a_reference_from_outside(tmp_path: Path) -> None:
    drive = export(SHAFT, "drive", "2", tmp_path)
    for is_external, want_rad in [(False, 0.0), (True, 0.25)]:
        with Fmu(drive, {"external_reference": is_external}) as fmu:
            fmu.set("reference_rad", 0.25)
            fmu.fmu.doStep(0.0, fmu.period_s)
            assert fmu.get("sent_reference_rad") == want_rad
            # The encoders stand at 0, and a count is 1.6 mrad.
            assert fmu.get("drive.load_error_rad") == pytest.approx(-want_rad, abs=1e-3)
            assert (fmu.get("torque_nm") > 0.5) == is_external


def test_fmpy_simulates_a_plant_with_a_changed_parameter(tmp_path: Path) -> None:
    plant = export(SMOOTH, "plant", "2", tmp_path)
    start = {"torque_nm": 0.5, "plant.initial.load_position_rad": 0.0, "plant.initial.motor_position_rad": 0.0}
    result = simulate_fmu(str(plant), stop_time=0.5, start_values=start, output=["motor_position_rad"])
    assert len(result) == 501
    # The free motor: t^2 U / 2 J, before the gap and its friction matter.
    assert result["motor_position_rad"][5] == pytest.approx(0.5 * 0.5 / 9.72e-4 * 0.005**2, rel=0.05)


def test_what_cannot_be_exported_is_refused_with_the_reason(tmp_path: Path) -> None:
    def refused(*words: str) -> str:
        command: list[str | Path] = [program(), "fmu", "export", SCENARIOS / SHAFT, *words, "--out", tmp_path / "a.fmu"]
        ended = subprocess.run(command, check=False, capture_output=True, text=True)
        assert ended.returncode == 2
        return ended.stderr

    text = refused("--of", "drive", "--set", "fault=[{at_s=1, kind='device-reset'}]")
    assert "can't be in the FMU of a drive: it strikes the line or the device" in text
    assert "nowhere.so: No such file" in refused("--of", "plant", "--library", str(tmp_path / "nowhere.so"))
    assert not list(tmp_path.iterdir())
