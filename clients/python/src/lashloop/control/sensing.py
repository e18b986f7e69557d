"""Encoder counts to positions and velocities, in single precision.

Counts stay integers as long as possible. Single precision holds 24 bits, so the difference of two converted positions
would lose the velocity, and the difference of motor and load the twist. A position is the middle of its count. A
velocity is the difference quotient after a first-order lag, discretised exactly for a held input. Every operation
rounds once to binary32, in the order of the firmware, so that the torque is the same to the bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lashloop.control import ControlInput, InconsistentError

if TYPE_CHECKING:
    from collections.abc import Mapping

f32 = np.float32

REFERENCE_JUMP_RAD = 0.02
"""Largest change of the reference per period that counts as motion."""
_LARGEST_RATIO_IN_COUNTS = 2**24


@dataclass(slots=True)
class Measurement:
    """One sample in physical units."""

    motor_position_rad: f32
    motor_velocity_rad_s: f32
    load_position_rad: f32
    load_velocity_rad_s: f32
    twist_rad: f32
    """Motor position less ratio times load position, computed from counts."""
    reference_position_rad: f32
    reference_velocity_rad_s: f32
    reference_acceleration_rad_s2: f32
    applied_torque_nm: f32


class _Channel:
    """One encoder, with the state of its velocity filter."""

    def __init__(self, counts_per_rev: float, bandwidth_rad_s: float, period_s: f32) -> None:
        self.half_count_rad = f32(np.pi) / f32(counts_per_rev)
        self._bandwidth_rad_s = f32(bandwidth_rad_s)
        self._alpha_per_period = _lag_alpha(self._bandwidth_rad_s, period_s)
        self._counts: int | None = None
        self.velocity_rad_s = f32(0.0)

    def advance(self, counts: int, periods: int, elapsed_s: f32) -> None:
        if self._counts is not None:
            moved = counts - self._counts
            velocity = f32(2 * moved) * self.half_count_rad / elapsed_s
            alpha = self._alpha_per_period if periods == 1 else _lag_alpha(self._bandwidth_rad_s, elapsed_s)
            self.velocity_rad_s += alpha * (velocity - self.velocity_rad_s)
        self._counts = counts


class _Reference:
    """Rates of the reference. A jump has no velocity, and the first velocity after a jump no acceleration."""

    def __init__(self) -> None:
        self._position_rad: f32 | None = None
        self._velocity_rad_s: f32 | None = None

    def advance(self, position_rad: f32, period_s: f32, periods: int) -> tuple[f32, f32]:
        before, self._position_rad = self._position_rad, position_rad
        velocity_before, self._velocity_rad_s = self._velocity_rad_s, None
        if before is None:
            return f32(0.0), f32(0.0)
        count = f32(periods)
        elapsed_s = period_s * count
        moved = position_rad - before
        if not abs(moved) <= f32(REFERENCE_JUMP_RAD) * count:
            return f32(0.0), f32(0.0)
        velocity = moved / elapsed_s
        self._velocity_rad_s = velocity
        if velocity_before is None:
            return velocity, f32(0.0)
        return velocity, (velocity - velocity_before) / elapsed_s


class Sensing:
    """Conversion of counts to measurements, from the first sample of a run."""

    def __init__(self, parameters: Mapping[str, float]) -> None:
        """Derive constants from the parameters; `InconsistentError` if the resolutions differ too much."""
        self._period_s = f32(parameters["period_us"]) * f32(1e-6)
        motor_counts, load_counts = (parameters[f"{side}_counts_per_rev"] for side in ("motor", "load"))
        self._motor = _Channel(motor_counts, parameters["motor_filter_rad_s"], self._period_s)
        self._load = _Channel(load_counts, parameters["load_filter_rad_s"], self._period_s)
        self._reference = _Reference()
        ratio = f32(parameters["reduction_ratio"]) * f32(motor_counts) / f32(load_counts)
        if not ratio <= _LARGEST_RATIO_IN_COUNTS:
            raise InconsistentError("reduction_ratio")
        self._whole_ratio = int(ratio)
        self._rest_of_ratio = ratio - f32(self._whole_ratio)

    def step(self, sample: ControlInput) -> Measurement:
        """Process one sample. The first sample has zero velocities."""
        periods = sample.elapsed_periods
        elapsed_s = self._period_s * f32(periods)
        motor, load = self._motor, self._load
        motor.advance(sample.motor_counts, periods, elapsed_s)
        load.advance(sample.load_counts, periods, elapsed_s)
        reference_rad = f32(sample.reference_rad)
        velocity_rad_s, acceleration_rad_s2 = self._reference.advance(reference_rad, self._period_s, periods)
        # Middles of the counts, in half counts.
        motor_half_counts, load_half_counts = 2 * sample.motor_counts + 1, 2 * sample.load_counts + 1
        whole = motor_half_counts - self._whole_ratio * load_half_counts
        rest = self._rest_of_ratio * f32(load_half_counts)
        return Measurement(
            motor_position_rad=f32(motor_half_counts) * motor.half_count_rad,
            motor_velocity_rad_s=motor.velocity_rad_s,
            load_position_rad=f32(load_half_counts) * load.half_count_rad,
            load_velocity_rad_s=load.velocity_rad_s,
            twist_rad=(f32(whole) - rest) * motor.half_count_rad,
            reference_position_rad=reference_rad,
            reference_velocity_rad_s=velocity_rad_s,
            reference_acceleration_rad_s2=acceleration_rad_s2,
            applied_torque_nm=f32(sample.applied_torque_nm),
        )


def _lag_alpha(rate: f32, time: f32) -> f32:
    """Gain of a first-order lag of `rate` (1/s) towards an input held for `time` (s)."""
    # Rounded once from double precision, where the error of expm1 is negligible in single precision.
    return f32(-np.expm1(np.float64(-(rate * time))))
