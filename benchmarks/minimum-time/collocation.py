"""Direct collocation of a movement of the plant `backlash-shaft`: successive legs with one contact each.

The equations are those of docs/model.md. State: load position and speed, motor position and speed, position in the gap,
torque of the motor. The torque command is constant over each interval; states are polynomials through Radau points.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, pi

import casadi
import numpy

import plant_values as plant

START = [pi / 2, 0.0, 3 * pi / 2, 0.0, 0.0, 0.0]
STATES = 6
LOAD, LOAD_SPEED, MOTOR, MOTOR_SPEED, GAP_POSITION, TORQUE = range(STATES)

MOTOR_SPEED_LIMIT_RAD_S = 1000.0
# Collocation needs dry friction of the motor without a jump, here of 0.02 N m: its sign changes over this speed.
MOTOR_SIGN_WIDTH_RAD_S = 0.1
DEGREE = 3
# An interval is short compared with 0.2 s, the period of the motor on the shaft.
LONGEST_INTERVAL_S = 0.05
# Of a long leg on the coarser mesh.
INTERVALS = 24
SHORTEST_LEG_S = 1e-5
LONGEST_LEG_S = 30.0


@dataclass(frozen=True)
class Leg:
    """A stretch of the movement with one contact: -1, 0 (free) or 1. The load sticks, or moves towards its target."""

    name: str
    contact: int
    sticks: bool
    # Conditions on the last state.
    end: Callable[[casadi.MX], list[casadi.MX]]
    # Intervals relative to those of a long leg.
    mesh: float = 1.0


@dataclass(frozen=True)
class LegSolution:
    """A leg as solved: states at the fractions of its duration, and one torque command for each interval."""

    duration_s: float
    fractions: numpy.ndarray
    states: numpy.ndarray
    torques_nm: numpy.ndarray


def stribeck(speed, coulomb, stiction, width):
    return coulomb + (stiction - coulomb) * casadi.exp(-((speed / width) ** 2))


def twist(x):
    return x[MOTOR] - plant.REDUCTION_RATIO * x[LOAD]


def twist_rate(x):
    return x[MOTOR_SPEED] - plant.REDUCTION_RATIO * x[LOAD_SPEED]


def transmitted(x, contact):
    """Torque of the shaft at the motor, N m."""
    if contact == 0:
        return 0
    wound = twist(x) - contact * plant.DEAD_ZONE_RAD
    return plant.STIFFNESS_NM_RAD * wound + plant.SHAFT_DAMPING_NM_S_RAD * twist_rate(x)


def rates(x, torque_nm, leg):
    shaft = transmitted(x, leg.contact)
    if leg.sticks:
        load_acceleration = 0
    else:
        dry = -stribeck(x[LOAD_SPEED], plant.LOAD_COULOMB_NM, plant.LOAD_STICTION_NM, plant.LOAD_STRIBECK_RAD_S)
        viscous = plant.LOAD_FRICTION_NM_S_RAD * x[LOAD_SPEED]
        load_acceleration = (plant.REDUCTION_RATIO * shaft - viscous - dry) / plant.LOAD_INERTIA_KG_M2
    motor_dry = casadi.tanh(x[MOTOR_SPEED] / MOTOR_SIGN_WIDTH_RAD_S) * stribeck(
        x[MOTOR_SPEED], plant.MOTOR_COULOMB_NM, plant.MOTOR_STICTION_NM, plant.MOTOR_STRIBECK_RAD_S
    )
    driving = x[TORQUE] - shaft - plant.MOTOR_FRICTION_NM_S_RAD * x[MOTOR_SPEED] - motor_dry
    relaxing = plant.STIFFNESS_NM_RAD / plant.SHAFT_DAMPING_NM_S_RAD * (twist(x) - x[GAP_POSITION])
    return casadi.vertcat(
        x[LOAD_SPEED],
        load_acceleration,
        x[MOTOR_SPEED],
        driving / plant.MOTOR_INERTIA_KG_M2,
        0 if leg.contact else twist_rate(x) + relaxing,
        (torque_nm - x[TORQUE]) / (plant.CURRENT_LAG_MS / 1e3),
    )


POINTS = [0.0, *casadi.collocation_points(DEGREE, "radau")]


def derivative_matrix():
    """Derivative of each Lagrange polynomial of POINTS at each point."""
    derivative = numpy.zeros((DEGREE + 1, DEGREE + 1))
    for j in range(DEGREE + 1):
        basis = numpy.poly1d([1.0])
        for r in range(DEGREE + 1):
            if r != j:
                basis *= numpy.poly1d([1.0, -POINTS[r]]) / (POINTS[j] - POINTS[r])
        for r in range(DEGREE + 1):
            derivative[j, r] = numpy.polyder(basis)(POINTS[r])
    return derivative


def fractions(intervals):
    """The nodes of a leg as fractions of its duration."""
    return numpy.array([0.0, *((k + point) / intervals for k in range(intervals) for point in POINTS[1:])])


class Movement:
    """The nonlinear program of a sequence of legs."""

    def __init__(self, torque_limit_nm, intervals):
        self.limit_nm = torque_limit_nm
        self.intervals = intervals
        self.opti = casadi.Opti()
        self.derivative = derivative_matrix()
        self.state = casadi.DM(START)
        self.legs = []

    def add(self, leg, guess):
        """Appends a leg with a guess of its solution."""
        opti = self.opti
        least = ceil(guess.duration_s / LONGEST_INTERVAL_S * self.intervals / INTERVALS)
        intervals = max(ceil(leg.mesh * self.intervals), least)
        duration = opti.variable()
        opti.subject_to(opti.bounded(SHORTEST_LEG_S, duration, LONGEST_LEG_S))
        opti.set_initial(duration, guess.duration_s)
        step = duration / intervals
        at = fractions(intervals)
        initial = [numpy.interp(at, guess.fractions, state) for state in guess.states]
        states, torques = [self.state], []
        for k in range(intervals):
            torque = opti.variable()
            opti.subject_to(opti.bounded(-self.limit_nm, torque, self.limit_nm))
            known = guess.torques_nm[min(int(k / intervals * len(guess.torques_nm)), len(guess.torques_nm) - 1)]
            opti.set_initial(torque, max(-self.limit_nm, min(known, self.limit_nm)))
            torques.append(torque)
            nodes = [states[-1]]
            for r in range(1, DEGREE + 1):
                node = opti.variable(STATES)
                opti.set_initial(node, [values[k * DEGREE + r] for values in initial])
                self.bound(leg, node)
                nodes.append(node)
            for r in range(1, DEGREE + 1):
                slope = sum(self.derivative[j, r] * nodes[j] for j in range(DEGREE + 1))
                opti.subject_to(slope == step * rates(nodes[r], torque, leg))
            states.extend(nodes[1:])
        for condition in leg.end(states[-1]):
            opti.subject_to(condition)
        self.state = states[-1]
        self.legs.append((leg.name, duration, at, casadi.horzcat(*states), casadi.vertcat(*torques)))

    def bound(self, leg, node):
        """Conditions within a leg."""
        opti = self.opti
        limit = MOTOR_SPEED_LIMIT_RAD_S
        opti.subject_to(opti.bounded(-limit, node[MOTOR_SPEED], limit))
        if leg.contact:
            opti.subject_to(leg.contact * transmitted(node, leg.contact) >= 0)
        else:
            opti.subject_to(opti.bounded(-plant.DEAD_ZONE_RAD, node[GAP_POSITION], plant.DEAD_ZONE_RAD))
        if leg.sticks and leg.contact:
            driving = plant.REDUCTION_RATIO * transmitted(node, leg.contact)
            opti.subject_to(opti.bounded(-plant.LOAD_STICTION_NM, driving, plant.LOAD_STICTION_NM))
        if not leg.sticks:
            opti.subject_to(node[LOAD_SPEED] <= 0)

    def solve(self, last_of_time, warm):
        """Minimises the time up to the end of the leg of this name; the legs by name, or None without a solution.

        `warm`: the guess is near a solution, so that the barrier begins low.
        """
        durations = [duration for _, duration, *_ in self.legs]
        counted = 1 + [name for name, *_ in self.legs].index(last_of_time)
        # The weight of what follows makes the solution unique. It costs less than a microsecond.
        self.opti.minimize(sum(durations[:counted]) + 1e-6 * sum(durations[counted:]))
        options = {"print_level": 0, "max_iter": 600, "tol": 1e-8, "sb": "yes", "mu_init": 1e-4 if warm else 0.1}
        self.opti.solver("ipopt", {"print_time": False, "expand": True}, options)
        try:
            solution = self.opti.solve()
        except RuntimeError:
            return None
        return {
            name: LegSolution(
                float(solution.value(duration)),
                at,
                numpy.asarray(solution.value(states)),
                numpy.atleast_1d(solution.value(torques)),
            )
            for name, duration, at, states, torques in self.legs
        }
