"""The cascaded PD law, "before compensation", of R. Merzouki and J. C. Cadiou.

"Estimation of backlash phenomenon in the electromechanical actuator", Control Engineering Practice 13 (2005) 973-983,
doi:10.1016/j.conengprac.2004.10.016. The outer loop, equation (17), computes the motor reference from the load error.
The inner loop, (16), computes the torque from the motor error and the error of the elastic torque. A moving reference
adds feed-forward torques for motor and load, (11) and (15).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lashloop.control import ControlInput, ControlLaw, ControlOutput, ParameterSpec, SignalSpec, signal
from lashloop.control import f32 as real
from lashloop.control.sensing import Measurement, Sensing, f32

if TYPE_CHECKING:
    from collections.abc import Mapping


PARAMETERS: tuple[ParameterSpec, ...] = (
    real("motor_filter_rad_s", "rad/s", 400.0, 0.01, 1e6),
    real("load_filter_rad_s", "rad/s", 200.0, 0.01, 1e6),
    real("k_p1", "N m/rad", 1.0, 0.0, 1e6, live=True),
    real("k_d1", "N m s/rad", 0.01, 0.0, 1e6, live=True),
    real("k_p2", "", 10.0, 0.0, 1e6, live=True),
    real("k_d2", "s", 10.0, 0.0, 1e6, live=True),
    real("k_1", "", 1.0, 0.0, 1e6, live=True),
    real("motor_inertia_kg_m2", "kg m^2", 9.72e-4, 1e-9, 1e3),
    real("motor_friction_nm_s_rad", "N m s/rad", 4.3e-4, 0.0, 1e4),
    real("motor_coulomb_nm", "N m", 0.0, 0.0, 1e3),
    real("load_inertia_kg_m2", "kg m^2", 7.5, 1e-9, 1e6),
    real("load_friction_nm_s_rad", "N m s/rad", 16.0, 0.0, 1e6),
    real("reduction_ratio", "", 3.0, 1e-3, 1e4),
    real("stiffness_nm_rad", "N m/rad", 1.0, 1e-6, 1e9),
    real("dead_zone_rad", "rad", 0.16, 1e-6, 10.0),
)
"""Filters, gains and nominal mechanics, with the paper's tables 1 and 2 as defaults.

They are those of the firmware's law. The gains are live. `motor_coulomb_nm` has no effect without compensation.
"""

SIGNALS: tuple[SignalSpec, ...] = (
    signal("measured_motor_velocity_rad_s", "rad/s"),
    signal("measured_load_velocity_rad_s", "rad/s"),
    signal("measured_twist_rad", "rad"),
    signal("measured_torque_nm", "N m"),
    signal("bridge_voltage_v", "V"),
    signal("dead_zone_estimate_rad", "rad"),
    signal("disturbing_torque_estimate_nm", "N m"),
    signal("load_error_rad", "rad"),
    signal("motor_error_rad", "rad"),
    signal("elastic_error_nm", "N m"),
)
"""Measurements, the gap and the disturbing torque of the model, and the errors of the two loops."""


class CascadedPd:
    """The two loops without compensation, in single precision and in the firmware's order of operations."""

    def __init__(self, parameters: Mapping[str, float]) -> None:
        """Take gains and nominal mechanics from the parameters of `docs/protocol/lashloop-drive.md`."""
        self._sensing = Sensing(parameters)
        self.update(parameters)
        value = {name: f32(number) for name, number in parameters.items()}
        self._stiffness_nm_rad = value["stiffness_nm_rad"]
        self._dead_zone_rad = float(value["dead_zone_rad"])
        self._ratio = value["reduction_ratio"]
        self._load_inertia = value["load_inertia_kg_m2"] / self._ratio
        self._load_friction = value["load_friction_nm_s_rad"] / self._ratio
        self._whole_inertia = value["motor_inertia_kg_m2"] * self._ratio + self._load_inertia
        self._whole_friction = value["motor_friction_nm_s_rad"] * self._ratio + self._load_friction

    def update(self, parameters: Mapping[str, float]) -> None:
        """Take over the gains, which are live; any values go together."""
        self._k_p1, self._k_d1 = f32(parameters["k_p1"]), f32(parameters["k_d1"])
        self._k_p2, self._k_d2 = f32(parameters["k_p2"]), f32(parameters["k_d2"])
        self._k_1 = f32(parameters["k_1"])

    def step(self, sample: ControlInput) -> ControlOutput:
        """Process one sample and return the torque for it."""
        # An overflow gives infinity or NaN, which the torque check of the drive detects.
        with np.errstate(all="ignore"):
            return self._law(self._sensing.step(sample))

    def _law(self, m: Measurement) -> ControlOutput:
        velocity, acceleration = m.reference_velocity_rad_s, m.reference_acceleration_rad_s2
        load_error = m.load_position_rad - m.reference_position_rad
        load_error_rate = m.load_velocity_rad_s - velocity
        # (11): the elastic torque minus the torque that moves the load.
        elastic_reference = self._load_inertia * acceleration + self._load_friction * velocity
        elastic_error = self._stiffness_nm_rad * m.twist_rad - elastic_reference
        # (17), relative to the motor position of the reference.
        motor_reference = (
            self._ratio * m.reference_position_rad - self._k_d2 * load_error_rate - self._k_p2 * load_error
        )
        motor_error = m.motor_position_rad - motor_reference
        # The rate of the motor reference, without the part that needs another derivative.
        motor_error_rate = m.motor_velocity_rad_s - self._ratio * velocity
        # (15), (16)
        torque = (
            (self._whole_inertia * acceleration + self._whole_friction * velocity)
            - self._k_1 * elastic_error
            - self._k_d1 * motor_error_rate
            - self._k_p1 * motor_error
        )
        return ControlOutput(
            torque_nm=float(torque),
            signals={
                "measured_motor_velocity_rad_s": float(m.motor_velocity_rad_s),
                "measured_load_velocity_rad_s": float(m.load_velocity_rad_s),
                "measured_twist_rad": float(m.twist_rad),
                "measured_torque_nm": float(m.applied_torque_nm),
                "bridge_voltage_v": 0.0,
                "dead_zone_estimate_rad": self._dead_zone_rad,
                "disturbing_torque_estimate_nm": 0.0,
                "load_error_rad": float(load_error),
                "motor_error_rad": float(motor_error),
                "elastic_error_nm": float(elastic_error),
            },
        )


PD = ControlLaw(name="pd", parameters=PARAMETERS, signals=SIGNALS, build=CascadedPd)
"""The law, for a drive to offer."""
