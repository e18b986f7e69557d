"""The smooth plant as an FMU of FMI 3.0, by pythonfmu3."""

from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability, Unit
from smooth_plant import Smooth


class Plant(Fmi3Slave):
    """The plant."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.plant = Smooth()
        self.torque = 0.0
        self.motor_start = 0.0
        self.load_start = 0.0
        self.time = 0.0
        self.register_units([Unit("rad", rad=1)])
        time = {"causality": Fmi3Causality.independent, "variability": Fmi3Variability.continuous}
        self.register_variable(Float64("time", **time))
        self.register_variable(Float64("torque", causality=Fmi3Causality.input))
        for name in ("motor", "load", "twist"):
            self.register_variable(Float64(name, causality=Fmi3Causality.output, unit="rad"))
        for name in ("motor_start", "load_start"):
            fixed = {"causality": Fmi3Causality.parameter, "variability": Fmi3Variability.fixed}
            self.register_variable(Float64(name, **fixed))

    motor = property(lambda self: self.plant.x[2])
    load = property(lambda self: self.plant.x[0])
    twist = property(lambda self: self.plant.x[2] - 3.0 * self.plant.x[0])

    def exit_initialization_mode(self):
        self.plant.x = [self.load_start, 0.0, self.motor_start, 0.0]

    def do_step(self, current_time, step_size):
        self.plant.hold(self.torque, step_size)
        return True
