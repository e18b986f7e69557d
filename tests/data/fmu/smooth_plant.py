"""The smooth plant of the paper, as `examples/plant-process` has it, for the slaves of the exporters."""

import math


class Smooth:
    """State and parameters."""

    def __init__(self):
        self.x = [0.0] * 4

    def rates(self, x, torque_nm):
        z = x[2] - 3.0 * x[0]
        c = z - 4 * 0.16 * math.tanh(z / (4 * 0.16))
        return [x[1], (3.0 * c - 16.0 * x[1]) / 7.5, x[3], (torque_nm - c - 4.3e-4 * x[3]) / 9.72e-4]

    def hold(self, torque_nm, h, substeps=4):
        for _ in range(substeps):
            k = [[0.0] * 4]
            for part in (0.0, h / substeps / 2, h / substeps / 2, h / substeps):
                k.append(self.rates([a + part * b for a, b in zip(self.x, k[-1])], torque_nm))
            sums = [k1 + 2 * k2 + 2 * k3 + k4 for k1, k2, k3, k4 in zip(*k[1:])]
            self.x = [a + h / substeps / 6 * rate for a, rate in zip(self.x, sums)]
