"""Minimum time for the plant `backlash-shaft`, the reference for the settling times of the control laws.

The plant of docs/model.md moves its load from pi/2 to 0, from rest. The drive's torque U, within +-U_max, is the only
input. Each leg of the movement has one contact and a free duration; direct collocation finds its states. Two minima:

rest    load and motor rest, the load within 0.05 rad of its target
settle  the load enters 0.05 rad for good, overshoots by at most 5 mrad, and comes to rest: the metric `settle_time_s`

Both count from the first sample and contain the delay of the torque. A controller also has a sampling period, quantised
encoders and unknown parameters; here all is known and U may change at any time. Minima are local: a faster movement
with other contacts is not excluded.

Every solution is computed on two meshes and simulated by an integrator of its own, simulation.py. The table has the
minimum on the finer mesh, its difference to the coarser one (empty where the finer mesh has no solution), and the largest difference of the load's position between
solution and simulation.

    pip install -r requirements.txt
    python minimum_time.py --out minimum-time.csv
    python minimum_time.py --torque-limits 20 10 --check minimum-time.csv
"""

import argparse
import csv
import sys
from dataclasses import dataclass, replace
from math import log, pi
from pathlib import Path

import numpy

import plant_values as plant
import simulation
from collocation import (
    GAP_POSITION,
    INTERVALS,
    LOAD,
    LOAD_SPEED,
    MOTOR,
    MOTOR_SPEED,
    START,
    STATES,
    Leg,
    LegSolution,
    Movement,
    transmitted,
)

BAND_RAD = 0.05
OVERSHOOT_RAD = 0.005
# From the middle outwards: a solution is the first guess of its neighbour.
TORQUE_LIMITS_NM = [8, 10, 15, 20, 5, 3, 2]
SIMULATION_STEP_S = 1e-5
# A leg that is shorter is not used.
VANISHED_S = 1e-3
DELAY_S = plant.TORQUE_DELAY_US / 1e6
N0, HALF_GAP, STICTION_NM = plant.REDUCTION_RATIO, plant.DEAD_ZONE_RAD, plant.LOAD_STICTION_NM


def at_flank(side):
    return lambda x: [x[GAP_POSITION] == side * HALF_GAP]


def breaks_loose(x):
    return [N0 * transmitted(x, -1) == -STICTION_NM]


def opens(side):
    return lambda x: [transmitted(x, side) == 0]


def in_band(x):
    return [x[LOAD] == BAND_RAD]


def stops(lowest_rad):
    return lambda x: [
        x[LOAD_SPEED] == 0,
        x[LOAD] >= lowest_rad,
        x[LOAD] <= BAND_RAD,
        N0 * transmitted(x, 1) <= STICTION_NM,
    ]


def sequences():
    """Target, sequence, legs, and the leg at whose end the time is taken.

    With little torque friction stops the load within the band: it enters while the motor still crosses the gap, or
    still accelerates.
    """
    gap = Leg("gap", 0, sticks=True, end=at_flank(-1), mesh=0.25)
    wind = Leg("wind", -1, sticks=True, end=breaks_loose, mesh=0.25)
    accelerate = Leg("accelerate", -1, sticks=False, end=opens(-1))
    cross = Leg("cross", 0, sticks=False, end=at_flank(1), mesh=0.25)
    brake = Leg("brake", 1, sticks=False, end=stops(-BAND_RAD))
    hold = Leg("hold", 1, sticks=True, end=lambda x: [x[MOTOR_SPEED] == 0], mesh=0.25)
    stop = replace(brake, name="stop", end=stops(-OVERSHOOT_RAD), mesh=0.5)
    entering = [replace(leg, end=in_band) for leg in (accelerate, cross, brake)]
    inside = [replace(leg, name=f"{leg.name} in band") for leg in (accelerate, cross)]
    yield "settle", "braking", [gap, wind, accelerate, cross, entering[2], stop], "brake"
    yield "settle", "crossing", [gap, wind, accelerate, entering[1], inside[1], stop], "cross"
    yield "settle", "accelerating", [gap, wind, entering[0], *inside, stop], "accelerate"
    yield "rest", "braking", [gap, wind, accelerate, cross, brake, hold], "hold"


# Duration, load position and speed at the end of each leg, for this torque limit.
GUESSED_NM = 20
GUESSES = {
    "gap": (0.005, pi / 2, 0.0),
    "wind": (0.01, pi / 2, 0.0),
    "accelerate": (0.5, 0.5, -2.5),
    "cross": (0.02, 0.45, -2.5),
    "brake": (0.3, 0.05, -1.25),
    "hold": (0.01, 0.0, 0.0),
    "stop": (0.1, 0.0, -0.3),
}


def first_guess(legs, stretch):
    """Straight lines, slower by `stretch` than with 20 N m."""
    solution, load = {}, START[LOAD]
    for leg in legs:
        duration_s, end, speed = GUESSES[leg.name.removesuffix(" in band")]
        speed /= stretch
        states = numpy.zeros((STATES, 2))
        states[LOAD] = [load, end]
        states[LOAD_SPEED] = speed
        shaft = leg.contact * (HALF_GAP + 1.0)
        states[MOTOR] = N0 * states[LOAD] + shaft
        states[MOTOR_SPEED] = N0 * speed
        states[GAP_POSITION] = leg.contact * HALF_GAP
        solution[leg.name] = LegSolution(duration_s, numpy.array([0.0, 1.0]), states, numpy.zeros(1))
        load = end
    return solution


def guess_of(legs, known, stretch):
    """The known solution, longer by `stretch` where the load accelerates; straight lines for a leg without one."""
    lines = first_guess(legs, stretch)
    guess = {}
    for leg in legs:
        found = known.get(leg.name) or known.get(leg.name.removesuffix(" in band")) or lines[leg.name]
        longer = stretch if leg.name.startswith("accelerate") else 1.0
        guess[leg.name] = replace(found, duration_s=found.duration_s * longer)
    return guess


def top_speed_rad_s(torque_limit_nm):
    """Load speed at which friction takes all of the torque."""
    return (N0 * torque_limit_nm - plant.LOAD_COULOMB_NM) / plant.LOAD_FRICTION_NM_S_RAD


def solve(torque_limit_nm, intervals, legs, timed, guess, warm):
    movement = Movement(torque_limit_nm, intervals)
    for leg in legs:
        movement.add(leg, guess[leg.name])
    return movement.solve(timed, warm)


def minimum_s(solution, timed):
    durations = {name: leg.duration_s for name, leg in solution.items()}
    counted = list(durations).index(timed) + 1
    return DELAY_S + sum(list(durations.values())[:counted])


def largest_difference_rad(solution):
    """Of the load's position, between solution and simulation."""
    pieces, times_s, loads_rad, begin_s = [], [], [], 0.0
    for leg in solution.values():
        pieces += [(leg.duration_s / len(leg.torques_nm), float(torque)) for torque in leg.torques_nm]
        times_s.append(begin_s + leg.fractions * leg.duration_s)
        loads_rad.append(leg.states[LOAD])
        begin_s += leg.duration_s
    at_s, have_rad, _ = simulation.run(START, pieces, SIMULATION_STEP_S)
    want_rad = numpy.interp(numpy.concatenate(times_s), at_s, have_rad)
    return float(numpy.max(numpy.abs(numpy.concatenate(loads_rad) - want_rad)))


COLUMNS = ("s", "sequence", "mesh_ms", "simulation_mrad")
HEADER = ["torque_limit_nm", *(f"{target}_{column}" for target in ("rest", "settle") for column in COLUMNS)]


@dataclass(frozen=True)
class Minimum:
    """The minimum of a sequence with its legs.

    `mesh_s` is its change from the coarser mesh, None if only that has a solution.
    """

    sequence: str
    time_s: float
    mesh_s: float | None
    last_leg_s: float
    legs: dict[str, LegSolution]

    def __str__(self):
        mesh = "coarser mesh alone" if self.mesh_s is None else f"{1e3 * self.mesh_s:.2f} ms from the coarser mesh"
        return f"{self.time_s:.5f} s, {mesh}"


class Study:
    """The minima by torque limit. Each limit starts from the solutions of the nearest one before."""

    def __init__(self, intervals):
        self.intervals = intervals
        # Target, sequence, torque limit and legs of every solution on the coarser mesh.
        self.known = []

    def row(self, torque_limit_nm):
        best = {}
        for target, sequence, legs, timed in sequences():
            # The next sequence enters the band one leg earlier, which is faster only if that leg vanishes.
            if target in best and best[target].last_leg_s > VANISHED_S:
                continue
            found = self.improve(torque_limit_nm, target, sequence, legs, timed)
            print(f"{torque_limit_nm:g} N m, {target}, {sequence}: {found or 'no solution'}", flush=True)
            if found and (target not in best or found.time_s < best[target].time_s):
                best[target] = found
        row = [f"{torque_limit_nm:g}"]
        for target in ("rest", "settle"):
            if target not in best:
                sys.exit(f"torque limit {torque_limit_nm:g} N m: no solution for {target}")
            found = best[target]
            simulated_mrad = 1e3 * largest_difference_rad(found.legs)
            mesh_ms = "" if found.mesh_s is None else f"{1e3 * found.mesh_s:.1f}"
            row += [f"{found.time_s:.3f}", found.sequence, mesh_ms, f"{simulated_mrad:.2f}"]
        print(",".join(row), flush=True)
        return row

    def nearest(self, torque_limit_nm, target, sequence):
        """The known solution that is likest, and its torque limit; None at the beginning."""
        if not self.known:
            return None

        def unlike(known):
            its_target, its_sequence, limit_nm, _ = known
            return its_target != target, its_sequence != sequence, abs(log(limit_nm / torque_limit_nm))

        *_, limit_nm, legs = min(self.known, key=unlike)
        return legs, limit_nm

    def first(self, torque_limit_nm, legs, timed, guesses):
        """The first solution of guesses: known legs with their torque limit, factor of the duration, near or not."""
        for (known, at_limit_nm), longer, warm in guesses:
            stretch = longer * top_speed_rad_s(at_limit_nm) / top_speed_rad_s(torque_limit_nm)
            guess = guess_of(legs, known, stretch)
            solution = solve(torque_limit_nm, self.intervals, legs, timed, guess, warm and bool(known))
            if solution is not None:
                return solution
        return None

    def improve(self, torque_limit_nm, target, sequence, legs, timed):
        """The minimum of a sequence; None without a solution."""
        lines = {}, GUESSED_NM
        nearest = self.nearest(torque_limit_nm, target, sequence) or lines
        # Not every guess leads to a solution, and not every solution is the fastest.
        first = self.first(torque_limit_nm, legs, timed, [(nearest, 1.0, True), (nearest, 1.0, False)])
        second = self.first(torque_limit_nm, legs, timed, [(lines, longer, False) for longer in (1.0, 1.3, 0.8)])
        found = [solution for solution in (first, second) if solution is not None]
        if not found:
            return None
        coarse = min(found, key=lambda solution: minimum_s(solution, timed))
        finer = (solve(torque_limit_nm, 2 * self.intervals, legs, timed, coarse, warm) for warm in (True, False))
        fine = next((solution for solution in finer if solution is not None), None)
        self.known.append((target, sequence, torque_limit_nm, coarse))
        if fine is None:
            return Minimum(sequence, minimum_s(coarse, timed), None, coarse[timed].duration_s, coarse)
        mesh_s = minimum_s(fine, timed) - minimum_s(coarse, timed)
        return Minimum(sequence, minimum_s(fine, timed), mesh_s, fine[timed].duration_s, fine)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--torque-limits",
        type=float,
        nargs="+",
        default=TORQUE_LIMITS_NM,
        metavar="NM",
        help="each starts from the nearest one before",
    )
    parser.add_argument("--intervals", type=int, default=INTERVALS, help="collocation intervals of a leg, at least")
    parser.add_argument("--out", type=Path, help="write the table as CSV")
    parser.add_argument("--check", type=Path, help="compare with this table; exit code 1 beyond 2 ms")
    arguments = parser.parse_args()
    study = Study(arguments.intervals)
    rows = [study.row(limit_nm) for limit_nm in arguments.torque_limits]
    if arguments.out:
        with arguments.out.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([HEADER, *sorted(rows, key=lambda row: float(row[0]))])
    if arguments.check:
        with arguments.check.open() as file:
            pinned = {row["torque_limit_nm"]: row for row in csv.DictReader(file)}
        for row in rows:
            have, want = dict(zip(HEADER, row, strict=True)), pinned[row[0]]
            if any(abs(float(have[key]) - float(want[key])) > 0.002 for key in ("rest_s", "settle_s")):
                sys.exit(f"torque limit {row[0]} N m: have {row}, the table has {list(want.values())}")


if __name__ == "__main__":
    main()
