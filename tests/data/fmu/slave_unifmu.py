"""The smooth plant behind the functions that UniFMU calls."""

from fmi2 import Fmi2FMU, Fmi2Status
from smooth_plant import Smooth


class Model(Fmi2FMU):
    """The plant; its attributes are the variables of the FMU."""

    def __init__(self, reference_to_attr=None):
        super().__init__(reference_to_attr)
        self.plant = Smooth()
        self.torque = self.motor = self.load = self.motor_start = self.load_start = 0.0

    def exit_initialization_mode(self):
        self.plant.x = [self.load_start, 0.0, self.motor_start, 0.0]
        return self.show()

    def do_step(self, current_time, step_size, no_step_prior):
        self.plant.hold(self.torque, step_size)
        return self.show()

    def show(self):
        self.motor, self.load = self.plant.x[2], self.plant.x[0]
        return Fmi2Status.ok
