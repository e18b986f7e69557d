#!/usr/bin/env python3
"""The smooth plant of the paper, equations (1) to (6), as a process: one line of JSON in, one line out."""
import json
import math
import sys

hello = json.loads(sys.stdin.readline())
assert hello["lashloop_plant"] == 1, "the bench has another version of the protocol"
table_1 = {"J_s": 7.5, "f_s": 16.0, "J_m": 9.72e-4, "f_m": 4.3e-4, "N0": 3.0, "K": 1.0, "j0": 0.16, "substeps": 4}
p = table_1 | hello["settings"]
x = [hello["initial"][f"{mass}_{what}"] for mass in ("load", "motor") for what in ("position_rad", "velocity_rad_s")]

def transmitted_nm(x):
    z = x[2] - p["N0"] * x[0]
    return p["K"] * (z - 4 * p["j0"] * math.tanh(z / (4 * p["j0"])))

def rates(x, torque_nm):
    c = transmitted_nm(x)
    load = (p["N0"] * c - p["f_s"] * x[1]) / p["J_s"]
    return [x[1], load, x[3], (torque_nm - c - p["f_m"] * x[3]) / p["J_m"]]

def runge_kutta(x, torque_nm, h):
    k = [[0.0] * 4]
    for part in (0.0, h / 2, h / 2, h):
        k.append(rates([a + part * b for a, b in zip(x, k[-1])], torque_nm))
    return [a + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4) for a, k1, k2, k3, k4 in zip(x, *k[1:])]

def reply(**more):
    values = [x[2] - p["N0"] * x[0], transmitted_nm(x), p["j0"]]
    state = {"motor_position_rad": x[2], "load_position_rad": x[0], "values": values}
    print(json.dumps(more | state, allow_nan=False), flush=True)

units = {"twist_rad": "rad", "transmitted_torque_nm": "N m", "dead_zone_rad": "rad"}
reply(lashloop_plant=1, signals=[{"name": name, "unit": unit} for name, unit in units.items()])
for line in sys.stdin:
    step = json.loads(line)
    for _ in range(p["substeps"]):
        x = runge_kutta(x, step["torque_nm"], step["dt_s"] / p["substeps"])
    reply()
