"""The plant `backlash-shaft` in small steps: an independent check of a solution of the collocation.

Fixed steps of Runge-Kutta's fourth order; after each step contact, load and motor change their modes. Friction is that
of docs/model.md, with exact sticking.
"""

from math import ceil, copysign, exp

import plant_values as plant

N0 = plant.REDUCTION_RATIO
K = plant.STIFFNESS_NM_RAD
DAMPING = plant.SHAFT_DAMPING_NM_S_RAD
HALF_GAP = plant.DEAD_ZONE_RAD
LAG_S = plant.CURRENT_LAG_MS / 1e3


class Plant:
    """Coordinates and modes. A friction mode is 0 while the mass sticks, else the sign of its motion."""

    def __init__(self, state):
        self.x = list(state)
        self.contact = 0
        self.load = 0
        self.motor = 0

    def transmitted(self, x):
        if self.contact == 0:
            return 0.0
        return K * (x[2] - N0 * x[0] - x[4]) + DAMPING * (x[3] - N0 * x[1])

    def rates(self, x, command):
        load, load_speed, motor, motor_speed, gap_position, torque = x
        shaft = self.transmitted(x)
        load_acceleration = motor_acceleration = gap_rate = 0.0
        if self.load:
            excess = plant.LOAD_STICTION_NM - plant.LOAD_COULOMB_NM
            dry = plant.LOAD_COULOMB_NM + excess * exp(-((load_speed / plant.LOAD_STRIBECK_RAD_S) ** 2))
            viscous = plant.LOAD_FRICTION_NM_S_RAD * load_speed
            load_acceleration = (N0 * shaft - viscous - self.load * dry) / plant.LOAD_INERTIA_KG_M2
        if self.motor:
            excess = plant.MOTOR_STICTION_NM - plant.MOTOR_COULOMB_NM
            dry = plant.MOTOR_COULOMB_NM + excess * exp(-((motor_speed / plant.MOTOR_STRIBECK_RAD_S) ** 2))
            viscous = plant.MOTOR_FRICTION_NM_S_RAD * motor_speed
            motor_acceleration = (torque - shaft - viscous - self.motor * dry) / plant.MOTOR_INERTIA_KG_M2
        if self.contact == 0:
            gap_rate = motor_speed - N0 * load_speed + K / DAMPING * (motor - N0 * load - gap_position)
        return (load_speed, load_acceleration, motor_speed, motor_acceleration, gap_rate, (command - torque) / LAG_S)

    def step(self, command, h):
        x = self.x
        k1 = self.rates(x, command)
        k2 = self.rates([a + h / 2 * b for a, b in zip(x, k1, strict=True)], command)
        k3 = self.rates([a + h / 2 * b for a, b in zip(x, k2, strict=True)], command)
        k4 = self.rates([a + h * b for a, b in zip(x, k3, strict=True)], command)
        self.x = [a + h / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(x, k1, k2, k3, k4, strict=True)]
        self.switch()

    def switch(self):
        """The modes after a step."""
        x = self.x
        if self.contact == 0:
            if abs(x[4]) >= HALF_GAP:
                self.contact = 1 if x[4] > 0 else -1
                x[4] = self.contact * HALF_GAP
        elif self.contact * self.transmitted(x) < 0:
            self.contact = 0
        shaft = self.transmitted(x)
        self.load, x[1] = friction_mode(self.load, x[1], N0 * shaft, plant.LOAD_STICTION_NM)
        self.motor, x[3] = friction_mode(self.motor, x[3], x[5] - shaft, plant.MOTOR_STICTION_NM)


def friction_mode(mode, speed, driving_nm, stiction_nm):
    """Mode and speed of a mass after a step."""
    if mode and speed * mode > 0:
        return mode, speed
    if abs(driving_nm) <= stiction_nm:
        return 0, 0.0
    return int(copysign(1, driving_nm)), speed if mode == 0 else 0.0


def run(start, pieces, step_s):
    """Times and load positions under torque commands: (duration in s, torque in N m) each."""
    simulated = Plant(start)
    time_s, times_s, loads_rad, speeds_rad_s = 0.0, [0.0], [start[0]], [0.0]
    for duration_s, torque_nm in pieces:
        steps = max(1, ceil(duration_s / step_s))
        h = duration_s / steps
        for _ in range(steps):
            simulated.step(torque_nm, h)
            time_s += h
            times_s.append(time_s)
            loads_rad.append(simulated.x[0])
            speeds_rad_s.append(simulated.x[1])
    return times_s, loads_rad, speeds_rad_s
