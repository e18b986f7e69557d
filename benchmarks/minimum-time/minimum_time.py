"""Minimum time for the plant `backlash-shaft`, the reference for the settling times of the control laws.

Optimal control by direct collocation: the plant of docs/model.md with the values of scenarios/shaft-backlash-inverse.toml, its contacts
and its stiction exact, moves its load from pi/2 to 0. The torque U of the drive, within +-U_max, is the only input. The sequence of
contacts is that of a fast movement: the motor crosses the gap, winds the shaft against the load at rest, accelerates the load, crosses
the gap again, and brakes. The time of each phase is free.

Two minima are computed:

rest     the load is at rest within 0.05 rad of its target, motor at rest, load held by its stiction
settle   the load enters the band of 0.05 rad for the last time and then comes to rest, with at most 5 mrad of overshoot.
         This is the metric `settle_time_s`, so no controller that overshoots by at most 5 mrad settles earlier.

Controllers additionally have a sampling period, quantised encoders and unknown parameters; here all is known and U may change at any
time. Minima are local, as always with direct collocation: a shorter movement with other contacts is not excluded.

Usage: python minimum_time.py [--torque-limits 20 8] [--intervals 24] [--check minimum-time.csv] [--out minimum-time.csv]
"""

import argparse
import csv
import sys
from dataclasses import dataclass
from math import pi
from pathlib import Path

import casadi
import numpy

# docs/model.md, plant `backlash-shaft`; SI units.
RATIO = 3.0
LOAD_INERTIA = 7.5
LOAD_FRICTION = 16.0
LOAD_COULOMB, LOAD_STICTION, LOAD_STRIBECK = 3.40, 3.82, 0.03
MOTOR_INERTIA = 9.72e-4
MOTOR_FRICTION = 4.3e-4
MOTOR_COULOMB, MOTOR_STICTION, MOTOR_STRIBECK = 0.02, 0.025, 0.2
STIFFNESS = 1.0
DAMPING = 3.1e-3
HALF_GAP = 0.16
CURRENT_LAG_S = 5e-4
# From the sample to the torque at the terminals of the current loop.
DELAY_S = 1e-3

START = [pi / 2, 0.0, 3 * pi / 2, 0.0, 0.0, 0.0]
BAND_RAD = 0.05
OVERSHOOT_RAD = 0.005
MOTOR_SPEED_LIMIT = 1000.0
# Width over which the motor's dry friction changes sign, rad/s: collocation needs a smooth one. It is 0.1 % of the torque limit.
MOTOR_SIGN_WIDTH = 0.5

DEGREE = 3
STATES = 6
LOAD, LOAD_SPEED, MOTOR, MOTOR_SPEED, CONTACT, TORQUE = range(STATES)


@dataclass(frozen=True)
class Phase:
    """A stretch of the movement with one contact: -1, 0 (free) or 1; the load sticks or moves backwards."""

    contact: int
    sticks: bool
    longest_s: float
    guess_s: float


GAP = Phase(contact=0, sticks=True, longest_s=0.1, guess_s=0.005)
WIND = Phase(contact=-1, sticks=True, longest_s=0.1, guess_s=0.01)
ACCELERATE = Phase(contact=-1, sticks=False, longest_s=30.0, guess_s=0.5)
CROSS = Phase(contact=0, sticks=False, longest_s=0.5, guess_s=0.02)
BRAKE = Phase(contact=1, sticks=False, longest_s=5.0, guess_s=0.3)
STOP = Phase(contact=1, sticks=False, longest_s=5.0, guess_s=0.1)


def stribeck(speed, coulomb, stiction, width):
    return coulomb + (stiction - coulomb) * casadi.exp(-((speed / width) ** 2))


def transmitted(x, contact):
    """Torque of the shaft at the motor, N m."""
    if contact == 0:
        return 0
    twist = x[MOTOR] - RATIO * x[LOAD]
    twist_speed = x[MOTOR_SPEED] - RATIO * x[LOAD_SPEED]
    return STIFFNESS * (twist - contact * HALF_GAP) + DAMPING * twist_speed


def rates(x, torque_nm, phase):
    twist = x[MOTOR] - RATIO * x[LOAD]
    twist_speed = x[MOTOR_SPEED] - RATIO * x[LOAD_SPEED]
    shaft = transmitted(x, phase.contact)
    if phase.sticks:
        load_acceleration = 0
    else:
        dry = -stribeck(x[LOAD_SPEED], LOAD_COULOMB, LOAD_STICTION, LOAD_STRIBECK)
        load_acceleration = (RATIO * shaft - LOAD_FRICTION * x[LOAD_SPEED] - dry) / LOAD_INERTIA
    motor_dry = casadi.tanh(x[MOTOR_SPEED] / MOTOR_SIGN_WIDTH) * stribeck(
        x[MOTOR_SPEED], MOTOR_COULOMB, MOTOR_STICTION, MOTOR_STRIBECK
    )
    motor_acceleration = (x[TORQUE] - shaft - MOTOR_FRICTION * x[MOTOR_SPEED] - motor_dry) / MOTOR_INERTIA
    contact_speed = 0 if phase.contact else twist_speed + STIFFNESS / DAMPING * (twist - x[CONTACT])
    lag = (torque_nm - x[TORQUE]) / CURRENT_LAG_S
    return casadi.vertcat(
        x[LOAD_SPEED], load_acceleration, x[MOTOR_SPEED], motor_acceleration, contact_speed, lag
    )


def collocation():
    """Derivative matrix and end weights of Radau points on [0, 1]."""
    points = [0.0, *casadi.collocation_points(DEGREE, "radau")]
    derivative = numpy.zeros((DEGREE + 1, DEGREE + 1))
    for j in range(DEGREE + 1):
        basis = numpy.poly1d([1.0])
        for r in range(DEGREE + 1):
            if r != j:
                basis *= numpy.poly1d([1.0, -points[r]]) / (points[j] - points[r])
        for r in range(DEGREE + 1):
            derivative[j, r] = numpy.polyder(basis)(points[r])
    return derivative


class Movement:
    """The program: phases one after the other, each with its collocation and its conditions."""

    def __init__(self, torque_limit_nm, intervals):
        self.limit_nm = torque_limit_nm
        self.intervals = intervals
        self.opti = casadi.Opti()
        self.derivative = collocation()
        self.state = casadi.DM(START)
        self.durations = []
        self.travelled = pi / 2

    def add(self, phase, load_end_guess, speed_guess):
        """Appends a phase and returns its first and last states."""
        opti, begin = self.opti, self.state
        duration = opti.variable()
        opti.subject_to(opti.bounded(1e-5, duration, phase.longest_s))
        opti.set_initial(duration, phase.guess_s)
        step = duration / self.intervals
        x = begin
        for k in range(self.intervals):
            torque = opti.variable()
            opti.subject_to(opti.bounded(-self.limit_nm, torque, self.limit_nm))
            nodes = [x]
            for _ in range(DEGREE):
                node = opti.variable(STATES)
                part = (k + 1) / self.intervals
                load = self.travelled + part * (load_end_guess - self.travelled)
                shaft = phase.contact * (HALF_GAP + 1.0)
                guess = [load, speed_guess, 3 * load + shaft, 3 * speed_guess, phase.contact * HALF_GAP, 0.0]
                opti.set_initial(node, guess)
                opti.subject_to(opti.bounded(-MOTOR_SPEED_LIMIT, node[MOTOR_SPEED], MOTOR_SPEED_LIMIT))
                if phase.contact:
                    opti.subject_to(phase.contact * transmitted(node, phase.contact) >= 0)
                else:
                    opti.subject_to(opti.bounded(-HALF_GAP, node[CONTACT], HALF_GAP))
                if phase.sticks and phase.contact:
                    hold = RATIO * transmitted(node, phase.contact)
                    opti.subject_to(opti.bounded(-LOAD_STICTION, hold, LOAD_STICTION))
                if not phase.sticks:
                    opti.subject_to(node[LOAD_SPEED] <= 0)
                nodes.append(node)
            for r in range(1, DEGREE + 1):
                slope = sum(self.derivative[j, r] * nodes[j] for j in range(DEGREE + 1))
                opti.subject_to(slope == step * rates(nodes[r], torque, phase))
            x = nodes[-1]
        self.durations.append(duration)
        self.state, self.travelled = x, load_end_guess
        return begin, x

    def require(self, condition):
        self.opti.subject_to(condition)

    def solve(self, objective):
        self.opti.minimize(objective)
        options = {"print_level": 0, "max_iter": 5000, "tol": 1e-9, "sb": "yes"}
        self.opti.solver("ipopt", {"print_time": False}, options)
        solution = self.opti.solve()
        return [float(solution.value(duration)) for duration in self.durations]


def minimum_s(torque_limit_nm, intervals, target):
    """The minimum time in seconds, delay included."""
    movement = Movement(torque_limit_nm, intervals)
    speed = -min(2.5, 0.15 * torque_limit_nm)
    _, x = movement.add(GAP, pi / 2, 0.0)
    movement.require(x[CONTACT] == -HALF_GAP)
    _, x = movement.add(WIND, pi / 2, 0.0)
    movement.require(RATIO * transmitted(x, -1) == -LOAD_STICTION)
    _, x = movement.add(ACCELERATE, 0.5, speed)
    movement.require(transmitted(x, -1) == 0)
    _, x = movement.add(CROSS, 0.45, speed)
    movement.require(x[CONTACT] == HALF_GAP)
    _, x = movement.add(BRAKE, BAND_RAD, speed / 2)
    entry = sum(movement.durations)
    if target == "settle":
        movement.require(x[LOAD] == BAND_RAD)
        _, x = movement.add(STOP, 0.0, speed / 8)
        movement.require(x[LOAD] >= -OVERSHOOT_RAD)
    else:
        movement.require(movement.opti.bounded(-BAND_RAD, x[LOAD], BAND_RAD))
        movement.require(x[MOTOR_SPEED] == 0)
    movement.require(x[LOAD_SPEED] == 0)
    movement.require(RATIO * transmitted(x, 1) <= LOAD_STICTION)
    movement.solve(entry)
    return DELAY_S + float(movement.opti.debug.value(entry))


def table(torque_limits_nm, intervals):
    rows = []
    for limit_nm in torque_limits_nm:
        minima = [minimum_s(limit_nm, intervals, target) for target in ("rest", "settle")]
        rows.append([f"{limit_nm:g}", *(f"{minimum:.3f}" for minimum in minima)])
        print("torque_limit_nm {}: rest {} s, settle {} s".format(*rows[-1]), flush=True)
    return rows


HEADER = ["torque_limit_nm", "rest_s", "settle_s"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--torque-limits", type=float, nargs="+", default=[5, 8, 10, 15, 20], metavar="NM")
    parser.add_argument("--intervals", type=int, default=24, help="collocation intervals of a phase")
    parser.add_argument("--out", type=Path, help="write the table as CSV")
    parser.add_argument("--check", type=Path, help="compare with this table; exit code 1 beyond 2 ms")
    arguments = parser.parse_args()
    rows = table(arguments.torque_limits, arguments.intervals)
    if arguments.out:
        with arguments.out.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([HEADER, *rows])
    if arguments.check:
        with arguments.check.open() as file:
            pinned = {row["torque_limit_nm"]: row for row in csv.DictReader(file)}
        for limit, *minima in rows:
            want = [float(pinned[limit][column]) for column in HEADER[1:]]
            if any(abs(float(have) - value) > 0.002 for have, value in zip(minima, want, strict=True)):
                sys.exit(f"torque limit {limit} N m: have {minima}, the table has {want}")


if __name__ == "__main__":
    main()
