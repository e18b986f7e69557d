#!/usr/bin/env python3
"""A model of MuJoCo as a plant: joints `motor` and `load`, and an actuator of the motor's torque."""
import json
import sys
from pathlib import Path

import mujoco

hello = json.loads(sys.stdin.readline())
assert hello["lashloop_plant"] == 1, "the bench has another version of the protocol"
model = mujoco.MjModel.from_xml_path(str(Path(__file__).parent / hello["settings"]["model"]))
data = mujoco.MjData(model)
motor, load = (model.joint(name) for name in ("motor", "load"))
gear = model.tendon("gear").id
ratio = float(-model.wrap_prm[model.tendon_adr[gear] + 1])
half_gap_rad = float(model.tendon_lengthspring[gear, 1])
for joint, mass in ((motor, "motor"), (load, "load")):
    data.qpos[joint.qposadr] = hello["initial"][f"{mass}_position_rad"]
    data.qvel[joint.dofadr] = hello["initial"][f"{mass}_velocity_rad_s"]
mujoco.mj_forward(model, data)


def reply(**more):
    motor_rad, load_rad = (float(data.qpos[joint.qposadr[0]]) for joint in (motor, load))
    twist_rad = motor_rad - ratio * load_rad
    state = {"motor_position_rad": motor_rad, "load_position_rad": load_rad, "values": [twist_rad, half_gap_rad]}
    print(json.dumps(more | state, allow_nan=False), flush=True)


units = {"twist_rad": "rad", "dead_zone_rad": "rad"}
reply(lashloop_plant=1, signals=[{"name": name, "unit": unit} for name, unit in units.items()])
for line in sys.stdin:
    step = json.loads(line)
    data.ctrl[0] = step["torque_nm"]
    steps = round(step["dt_s"] / model.opt.timestep)
    assert abs(steps * model.opt.timestep - step["dt_s"]) < 1e-9, "the time step of the model doesn't divide the period"
    mujoco.mj_step(model, data, nstep=steps)
    reply()
