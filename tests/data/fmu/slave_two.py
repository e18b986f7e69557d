"""The smooth plant as an FMU of FMI 2.0, by pythonfmu."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from smooth_plant import Smooth


class Plant(Fmi2Slave):
    """The plant."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.plant = Smooth()
        self.torque = 0.0
        self.motor_start = 0.0
        self.load_start = 0.0
        self.register_variable(Real("torque", causality=Fmi2Causality.input))
        for name in ("motor", "load", "twist"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))
        for name in ("motor_start", "load_start"):
            fixed = Fmi2Variability.fixed
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=fixed))

    motor = property(lambda self: self.plant.x[2])
    load = property(lambda self: self.plant.x[0])
    twist = property(lambda self: self.plant.x[2] - 3.0 * self.plant.x[0])

    def exit_initialization_mode(self):
        self.plant.x = [self.load_start, 0.0, self.motor_start, 0.0]

    def do_step(self, current_time, step_size):
        self.plant.hold(self.torque, step_size)
        return True
