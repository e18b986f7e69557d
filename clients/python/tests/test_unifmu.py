"""An FMU of UniFMU, which runs Python in a process of its own, as a plant."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import lashloop
from support import SOON_S, WORKSPACE, program

DATA = WORKSPACE / "tests" / "data" / "fmu"
VARIABLE = '<ScalarVariable name="{}" valueReference="{}" variability="{}" causality="{}"{}><Real{}/></ScalarVariable>'
VARIABLES = [
    VARIABLE.format("torque", 0, "continuous", "input", "", ' start="0"'),
    VARIABLE.format("motor", 1, "continuous", "output", ' initial="calculated"', ""),
    VARIABLE.format("load", 2, "continuous", "output", ' initial="calculated"', ""),
    VARIABLE.format("motor_start", 3, "fixed", "parameter", "", ' start="0"'),
    VARIABLE.format("load_start", 4, "fixed", "parameter", "", ' start="0"'),
]
STRUCTURE = "<ModelStructure><Outputs><Unknown index='2'/><Unknown index='3'/></Outputs></ModelStructure>"
SCENARIO = """title = "A plant of UniFMU"

[run]
duration_s = 2.0

{plant}
[plant.initial]
motor_position_rad = 4.71238898038469
load_position_rad = 1.5707963267948966

[encoders]
motor_counts_per_rev = 131072
load_counts_per_rev = 131072

[controller]
name = "merzouki"

[reference]
profile = "constant"
position_rad = 0.0
"""
FMU = """[plant]
model = "fmu"
file = "plant.fmu"
torque_input = "torque"
motor_output = "motor"
load_output = "load"

[plant.start]
motor_start = 4.71238898038469
load_start = 1.5707963267948966
"""
SMOOTH = '[plant]\nmodel = "smooth"\n'


def build(folder: Path) -> None:
    """Make `plant.fmu` in the folder."""
    source = folder / "source"
    unifmu = Path(sys.executable).with_name("unifmu")
    subprocess.run([unifmu, "generate", "python", source], check=True, timeout=SOON_S, capture_output=True)
    shutil.copy(DATA / "slave_unifmu.py", source / "resources" / "model.py")
    shutil.copy(DATA / "smooth_plant.py", source / "resources")
    description = source / "modelDescription.xml"
    body = "<ModelVariables>" + "".join(VARIABLES) + "</ModelVariables>" + STRUCTURE
    text = re.sub(r"<ModelVariables>.*</ModelStructure>", body, description.read_text(), flags=re.DOTALL)
    description.write_text(text)
    launch = source / "resources" / "launch.toml"
    launch.write_text(launch.read_text().replace('"grpc"', '"zmq"', 1).replace('["python3"', f'["{sys.executable}"'))
    archive = shutil.make_archive(str(folder / "plant"), "zip", source)
    Path(archive).rename(folder / "plant.fmu")


def test_an_fmu_of_unifmu_moves_as_the_smooth_plant_does(tmp_path: Path) -> None:
    build(tmp_path)
    digests = []
    for number, plant in enumerate([FMU, FMU, SMOOTH]):
        scenario = tmp_path / f"{number}.toml"
        scenario.write_text(SCENARIO.format(plant=plant))
        record = lashloop.run(scenario, device="inproc", program=program(), timeout_s=SOON_S)
        assert record.verdict is lashloop.Verdict.PASS
        digests.append(record.summary["torque_sha256"])
    # The encoders are read from positions that agree to well below a count.
    assert digests == [digests[0]] * 3
