"""Frequency responses of the `lashloop` program, with SciPy as the judge of the drive train."""

from __future__ import annotations

import csv
import math
import subprocess
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy import signal

from support import SOON_S, program

if TYPE_CHECKING:
    from pathlib import Path

PERIOD_S = 1e-3
MOTOR_INERTIA, MOTOR_FRICTION = 9.72e-4, 4.3e-4
LOAD_INERTIA, LOAD_FRICTION = 7.5, 16.0
STIFFNESS, DAMPING, RATIO, LAG_S = 1.0, 3.1e-3, 3.0, 5e-4
COUNTS = 1 << 24

# A torque on the load holds the contact closed: one that opens is not linear.
SCENARIO = f"""
title = "two masses"
meant = ["mismatch"]
[run]
duration_s = 1.0
[plant]
model = "backlash-shaft"
dead_zone_rad = 1e-6
load_coulomb_nm = 0.0
load_stiction_nm = 0.0
motor_coulomb_nm = 0.0
motor_stiction_nm = 0.0
load_torque.torque_nm = 6.0
initial = {{ load_position_rad = 0.0, motor_position_rad = 0.0 }}
[encoders]
motor_counts_per_rev = {COUNTS}
load_counts_per_rev = {COUNTS}
[controller]
name = "pd"
[reference]
profile = "constant"
position_rad = 0.0
"""


def drive_train() -> signal.StateSpace:
    """The drive train from the torque to both positions: two masses, a shaft, and the lag of the current loop."""
    # Positions and velocities of motor and load, then the torque at the motor.
    twist = np.array([STIFFNESS, DAMPING, -RATIO * STIFFNESS, -RATIO * DAMPING, 0.0])
    motor = (np.array([0.0, -MOTOR_FRICTION, 0.0, 0.0, 1.0]) - twist) / MOTOR_INERTIA
    load = (np.array([0.0, 0.0, 0.0, -LOAD_FRICTION, 0.0]) + RATIO * twist) / LOAD_INERTIA
    a = np.array([[0, 1, 0, 0, 0], motor, [0, 0, 0, 1, 0], load, [0, 0, 0, 0, -1 / LAG_S]])
    b = np.array([[0], [0], [0], [0], [1 / LAG_S]])
    c = np.array([[1, 0, 0, 0, 0], [0, 0, 1, 0, 0]])
    return signal.StateSpace(a, b, c, np.zeros((2, 1)))


def sampled(frequency_hz: float) -> np.ndarray:
    """The response with a hold of a period, by the exact matrix exponential, and the delay of a period."""
    discrete = drive_train().to_discrete(PERIOD_S, method="zoh")
    z = np.exp(2j * math.pi * frequency_hz * PERIOD_S)
    states = np.linalg.solve(z * np.eye(5) - discrete.A, discrete.B)
    return np.asarray((discrete.C @ states)[:, 0] / z)


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, str]]:
    folder: Path = tmp_path_factory.mktemp("bode")
    scenario, table = folder / "linear.toml", folder / "bode.csv"
    scenario.write_text(SCENARIO)
    command = [str(program()), "bode", str(scenario), "--csv", str(table)]
    subprocess.run(command, check=True, capture_output=True, timeout=SOON_S)
    with table.open(newline="") as lines:
        return list(csv.DictReader(lines))


def errors(rows: list[dict[str, str]], response: str, output: int) -> list[tuple[float, float, float, float]]:
    """Frequency, stated interval and error in dB, and error in degrees of each line with a coherence above 0.95."""
    found = []
    for row in rows:
        if row["response"] != response or float(row["coherence"]) <= 0.95:
            continue
        frequency_hz = float(row["frequency_hz"])
        ratio = complex(float(row["real"]), float(row["imaginary"])) / sampled(frequency_hz)[output]
        found.append(
            (
                frequency_hz,
                float(row["within_db"]),
                20 * math.log10(abs(ratio)),
                math.degrees(math.atan2(ratio.imag, ratio.real)),
            )
        )
    return found


def test_response_of_the_motor_is_that_of_scipy_within_a_tenth_of_a_decibel_and_a_degree(
    rows: list[dict[str, str]],
) -> None:
    found = errors(rows, "motor", 0)
    assert len(found) > 40
    for frequency_hz, _, error_db, error_deg in found:
        assert abs(error_db) < 0.1, f"{frequency_hz} Hz: {error_db} dB"
        assert abs(error_deg) < 1.0, f"{frequency_hz} Hz: {error_deg} degrees"


def test_response_of_the_load_is_that_of_scipy_or_states_a_wider_interval(rows: list[dict[str, str]]) -> None:
    found = errors(rows, "load", 1)
    assert len(found) > 20
    # Nine of ten: an interval of 95 % misses now and then.
    missed = [it for it in found if abs(it[2]) >= max(0.1, it[1])]
    assert len(missed) <= len(found) / 10, missed
