"""The law of the profile `pd`, written from its annex of the specification alone, in any precision."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from lashloop.control import ControlInput, ControlOutput

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Real = np.floating

JUMP_RAD = 0.02
"""Largest change of the reference per period that is motion."""
GAINS = ("k_p1", "k_d1", "k_p2", "k_d2", "k_1")
"""The live parameters of the law."""


class SpecifiedPd:
    """The law with its constants and its state; every operation is one of `real`."""

    def __init__(self, parameters: Mapping[str, float], real: Callable[[float], Real] = np.float32) -> None:
        """Compute the constants of the section."""
        self._real = real
        it = {name: real(value) for name, value in parameters.items()}
        self._it = it
        self._period_s = it["period_us"] * real(1e-6)
        self._half_motor = real(math.pi) / it["motor_counts_per_rev"]
        self._half_load = real(math.pi) / it["load_counts_per_rev"]
        rho = it["reduction_ratio"] * it["motor_counts_per_rev"] / it["load_counts_per_rev"]
        self._whole = int(rho)
        self._rest = rho - real(self._whole)
        self._load_inertia = it["load_inertia_kg_m2"] / it["reduction_ratio"]
        self._load_friction = it["load_friction_nm_s_rad"] / it["reduction_ratio"]
        self._whole_inertia = it["motor_inertia_kg_m2"] * it["reduction_ratio"] + self._load_inertia
        self._whole_friction = it["motor_friction_nm_s_rad"] * it["reduction_ratio"] + self._load_friction
        self._counts: tuple[int, int] | None = None
        self._motor_velocity = self._load_velocity = real(0.0)
        self._reference = real(0.0)
        self._reference_velocity: Real | None = None

    def update(self, parameters: Mapping[str, float]) -> None:
        """Take over the gains."""
        self._it |= {name: self._real(parameters[name]) for name in GAINS}

    def step(self, sample: ControlInput) -> ControlOutput:
        """Compute the torque of one sample, and the signals of the Lashloop drive."""
        # A number out of range gives infinity or NaN, as in the drive; the check of the torque detects it.
        with np.errstate(all="ignore"):
            return self._step(sample)

    def _step(self, sample: ControlInput) -> ControlOutput:
        real, it = self._real, self._it
        velocity, acceleration = self._rates(sample)
        motor_halves, load_halves = 2 * sample.motor_counts + 1, 2 * sample.load_counts + 1
        motor, load = real(motor_halves) * self._half_motor, real(load_halves) * self._half_load
        twist = (real(motor_halves - self._whole * load_halves) - self._rest * real(load_halves)) * self._half_motor
        reference = real(sample.reference_rad)
        load_error = load - reference
        elastic_error = it["stiffness_nm_rad"] * twist - (
            self._load_inertia * acceleration + self._load_friction * velocity
        )
        command = it["reduction_ratio"] * reference - it["k_d2"] * (self._load_velocity - velocity)
        motor_error = motor - (command - it["k_p2"] * load_error)
        torque = self._whole_inertia * acceleration + self._whole_friction * velocity
        torque -= it["k_1"] * elastic_error
        torque -= it["k_d1"] * (self._motor_velocity - it["reduction_ratio"] * velocity)
        torque -= it["k_p1"] * motor_error
        signals = {
            "measured_motor_velocity_rad_s": self._motor_velocity,
            "measured_load_velocity_rad_s": self._load_velocity,
            "measured_twist_rad": twist,
            "measured_torque_nm": real(sample.applied_torque_nm),
            "bridge_voltage_v": real(0.0),
            "dead_zone_estimate_rad": it.get("dead_zone_rad", real(0.0)),
            "disturbing_torque_estimate_nm": real(0.0),
            "load_error_rad": load_error,
            "motor_error_rad": motor_error,
            "elastic_error_nm": elastic_error,
        }
        return ControlOutput(float(torque), {name: float(value) for name, value in signals.items()})

    def _rates(self, sample: ControlInput) -> tuple[Real, Real]:
        """Advance the filters; velocity and acceleration of the reference."""
        real = self._real
        before, self._counts = self._counts, (sample.motor_counts, sample.load_counts)
        reference_before, self._reference = self._reference, real(sample.reference_rad)
        velocity_before, self._reference_velocity = self._reference_velocity, None
        if before is None:
            return real(0.0), real(0.0)
        periods = real(sample.elapsed_periods)
        time_s = self._period_s * periods
        motor = real(2 * (sample.motor_counts - before[0])) * self._half_motor / time_s
        load = real(2 * (sample.load_counts - before[1])) * self._half_load / time_s
        self._motor_velocity += self._gain("motor_filter_rad_s", time_s) * (motor - self._motor_velocity)
        self._load_velocity += self._gain("load_filter_rad_s", time_s) * (load - self._load_velocity)
        moved = self._reference - reference_before
        if not abs(moved) <= real(JUMP_RAD) * periods:
            return real(0.0), real(0.0)
        velocity = self._reference_velocity = moved / time_s
        return velocity, real(0.0) if velocity_before is None else (velocity - velocity_before) / time_s

    def _gain(self, bandwidth: str, time_s: Real) -> Real:
        return self._real(-np.expm1(np.float64(-(self._it[bandwidth] * time_s))))
