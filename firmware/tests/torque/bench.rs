//! A motor on a bridge, and the drive's control of it, period by period.

use lashloop_firmware::torque::{BridgeReading, Motor, SensorCheck, SensorOffset, TorqueControl};
use lashloop_plant::electrical::{Bridge, Circuit, CurrentSensor, ElectricalParameters};

/// The motor of the examples, at 10 kHz: the slowest modulation of a current loop.
pub fn at_10_khz() -> ElectricalParameters {
    ElectricalParameters { pwm_hz: 1e4, ..ElectricalParameters::example() }
}

/// The motor that a drive believes in, with resistance and inductance off by these factors.
pub fn believed(parameters: &ElectricalParameters, resistance: f64, inductance: f64) -> Motor {
    Motor {
        resistance_ohm: (parameters.resistance_ohm * resistance) as f32,
        inductance_h: (parameters.inductance_h * inductance) as f32,
        torque_constant_nm_a: parameters.torque_constant_nm_a as f32,
    }
}

/// A motor whose shaft turns at a given speed.
pub struct Bench {
    pub circuit: Circuit,
    pub speed_rad_s: f64,
    sensor: CurrentSensor,
    offset: SensorOffset,
    control: TorqueControl,
    check: SensorCheck,
    duty: f64,
    /// What the sensor shows of the current, as a factor.
    pub sense: f64,
    /// Whether the drive has found the sensor wrong.
    pub is_doubted: bool,
}

impl Bench {
    /// The bench with the control of a believed motor, after the drive has measured the offset of the sensor.
    pub fn new(parameters: ElectricalParameters, motor: Motor) -> Self {
        let mut bench = Self {
            circuit: Circuit::new(parameters),
            speed_rad_s: 0.0,
            sensor: CurrentSensor::new(1),
            offset: SensorOffset::default(),
            control: TorqueControl::by_current(motor, (1.0 / parameters.pwm_hz) as f32, 1.0),
            // The limit of the current is half the range.
            check: SensorCheck::new(
                motor,
                (1.0 / parameters.pwm_hz) as f32,
                parameters.sense_range_a as f32 / 128.0,
                parameters.sense_range_a as f32 / 20.0,
            ),
            duty: 0.0,
            sense: 1.0,
            is_doubted: false,
        };
        while bench.offset.reading().is_none() {
            let reading = bench.converter();
            bench.offset.take(reading);
        }
        bench
    }

    /// What a converter of 12 bits reads.
    fn converter(&mut self) -> u32 {
        let fraction = self.sensor.read(self.circuit.parameters(), self.sense * self.circuit.current_a());
        (2048.0 * (1.0 + fraction)) as u32
    }

    /// Makes a period: the second half has the duty of the sample in its middle. Returns the torque in the middle, in N m.
    pub fn period(&mut self, torque_nm: f64) -> f64 {
        let parameters = *self.circuit.parameters();
        let half_s = 0.5 / parameters.pwm_hz;
        self.circuit.step(Bridge::Driving(self.duty), self.speed_rad_s, half_s);
        let offset = self.offset.reading().expect("a measured offset");
        let above = self.converter() as f32 - offset;
        let current_a = above * parameters.sense_range_a as f32 / 2048.0;
        let reading = BridgeReading { current_a, bus_v: self.circuit.bus_v() as f32 };
        let (command_nm, speed_rad_s) = (torque_nm as f32, self.speed_rad_s as f32);
        let duty = self.control.duty(command_nm, speed_rad_s, &reading);
        self.is_doubted |= self.check.step(command_nm, speed_rad_s, &reading, duty);
        self.duty = duty.into();
        let torque_nm = parameters.torque_constant_nm_a * self.circuit.current_a();
        self.circuit.step(Bridge::Driving(self.duty), self.speed_rad_s, half_s);
        torque_nm
    }
}
