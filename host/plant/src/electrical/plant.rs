//! A plant behind a bridge: the drive's torque becomes a voltage, and the current makes the torque.

use super::circuit::{Bridge, Circuit};
use super::parameters::ElectricalParameters;
use super::sensor::CurrentSensor;
use crate::{Environment, Plant, PlantError, Positions, Release, Signal};

/// Signals after those of the plant itself.
const SIGNALS: [Signal; 4] = [
    Signal::new("commanded_torque_nm", "N m"),
    Signal::new("motor_current_a", "A"),
    Signal::new("bridge_duty", ""),
    Signal::new("bus_voltage_v", "V"),
];

/// Readings of the sensor with the bridge off, before the first step.
pub const REST_READINGS: usize = 1024;

/// What a drive knows when it computes a duty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageReading {
    /// The torque that the drive commands, in N m.
    pub torque_nm: f64,
    /// The current that the sensor shows, as a fraction of its range, -1 to 1.
    pub current: f64,
    /// Voltage of the bus in V.
    pub bus_v: f64,
    /// Speed of the motor in rad/s.
    pub speed_rad_s: f64,
}

/// The part of a drive that makes a duty of a torque.
pub trait StageControl: Send {
    /// Takes what the sensor shows at no current, as a fraction of its range. Called [`REST_READINGS`] times before the first step.
    fn rest(&mut self, _current: f64) {}

    /// The duty of the next period of the modulation, -1 to 1. Called in the middle of every period.
    fn duty(&mut self, reading: &StageReading) -> f64;
}

/// Any plant behind a bridge.
pub struct ElectricalPlant {
    plant: Box<dyn Plant>,
    circuit: Circuit,
    sensor: CurrentSensor,
    control: Box<dyn StageControl>,
    signals: Vec<Signal>,
    duty: f64,
    commanded_nm: f64,
    motor_position_rad: f64,
    speed_rad_s: f64,
    /// Time left in this half of a period of the modulation, in s.
    left_s: f64,
    /// Whether this half is the second one, which follows the sample.
    is_second_half: bool,
}

impl ElectricalPlant {
    /// A plant at rest behind a bridge with these parameters; `seed` starts the noise of the sensor.
    ///
    /// # Errors
    /// Names the parameter outside its range.
    pub fn new(
        plant: Box<dyn Plant>,
        parameters: ElectricalParameters,
        mut control: Box<dyn StageControl>,
        seed: u64,
    ) -> Result<Self, PlantError> {
        parameters.validate()?;
        let mut sensor = CurrentSensor::new(seed);
        for _ in 0..REST_READINGS {
            control.rest(sensor.read(&parameters, 0.0));
        }
        Ok(Self {
            signals: plant.signals().iter().cloned().chain(SIGNALS).collect(),
            motor_position_rad: plant.positions().motor_position_rad,
            plant,
            circuit: Circuit::new(parameters),
            sensor,
            control,
            duty: 0.0,
            commanded_nm: 0.0,
            speed_rad_s: 0.0,
            left_s: half_period_s(&parameters),
            is_second_half: false,
        })
    }

    /// The electrical state.
    #[must_use]
    pub fn circuit(&self) -> &Circuit {
        &self.circuit
    }

    fn advance(&mut self, dt_s: f64) -> Result<(), PlantError> {
        let mean_a = self.circuit.step(Bridge::Driving(self.duty), self.speed_rad_s, dt_s);
        self.plant.step(self.circuit.parameters().torque_constant_nm_a * mean_a, dt_s)?;
        let Positions { motor_position_rad, .. } = self.plant.positions();
        self.speed_rad_s = (motor_position_rad - self.motor_position_rad) / dt_s;
        self.motor_position_rad = motor_position_rad;
        Ok(())
    }

    /// The middle or the end of a period.
    fn turn(&mut self) {
        self.left_s += half_period_s(self.circuit.parameters());
        self.is_second_half = !self.is_second_half;
        if self.is_second_half {
            self.duty = self.control.duty(&StageReading {
                torque_nm: self.commanded_nm,
                current: self.sensor.read(self.circuit.parameters(), self.circuit.current_a()),
                bus_v: self.circuit.bus_v(),
                speed_rad_s: self.speed_rad_s,
            });
        }
    }
}

fn half_period_s(parameters: &ElectricalParameters) -> f64 {
    0.5 / parameters.pwm_hz
}

impl Plant for ElectricalPlant {
    fn signals(&self) -> &[Signal] {
        &self.signals
    }

    fn truth(&self, values: &mut [f64]) {
        let of_plant = values.len().saturating_sub(SIGNALS.len());
        let (of_plant, own) = values.split_at_mut(of_plant);
        self.plant.truth(of_plant);
        let present = [self.commanded_nm, self.circuit.current_a(), self.duty, self.circuit.bus_v()];
        own.copy_from_slice(&present[..own.len()]);
    }

    fn positions(&self) -> Positions {
        self.plant.positions()
    }

    fn judged_load_position_rad(&self) -> f64 {
        self.plant.judged_load_position_rad()
    }

    fn step(&mut self, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        if !torque_nm.is_finite() {
            return Err(PlantError::Torque { torque_nm });
        }
        if !(dt_s.is_finite() && dt_s >= 0.0) {
            return Err(PlantError::Duration { dt_s });
        }
        self.commanded_nm = torque_nm;
        let mut rest_s = dt_s;
        // Less than a nanosecond is the rounding of sums.
        while rest_s > 1e-9 {
            let part_s = rest_s.min(self.left_s);
            self.advance(part_s)?;
            rest_s -= part_s;
            self.left_s -= part_s;
            if self.left_s <= 1e-9 {
                self.turn();
            }
        }
        Ok(())
    }

    fn set_environment(&mut self, environment: Environment) -> Result<(), PlantError> {
        self.plant.set_environment(environment)
    }

    fn change_parameters(&mut self, release: &Release<'_>) -> Result<(), PlantError> {
        self.plant.change_parameters(release)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{PlantValue, Start, smooth};

    /// A stage that is scaled at standstill: it knows the resistance and nothing of the back-EMF.
    struct Scaled;

    impl StageControl for Scaled {
        fn duty(&mut self, reading: &StageReading) -> f64 {
            0.5 / 0.24 * reading.torque_nm / reading.bus_v
        }
    }

    /// A motor that turns almost freely: its load follows behind a soft spring.
    fn released(pwm_hz: f64) -> ElectricalPlant {
        let model = smooth::model();
        let mut values = model.defaults();
        values.insert("stiffness_nm_rad", PlantValue::Number(1e-6));
        let start = Start::at_rest(0.0, 0.0);
        let release = Release { values: &values, start, period_s: 1e-3, folder: Path::new("") };
        let parameters = ElectricalParameters { pwm_hz, dead_time_s: 0.0, ..ElectricalParameters::example() };
        let plant = model.release(&release).expect("a plant");
        ElectricalPlant::new(plant, parameters, Box::new(Scaled), 1).expect("a plant behind a bridge")
    }

    fn signal(plant: &ElectricalPlant, name: &str) -> f64 {
        let mut values = vec![f64::NAN; plant.signals().len()];
        plant.truth(&mut values);
        let at = plant.signals().iter().position(|signal| signal.name == name).expect("a signal");
        values[at]
    }

    #[test]
    fn a_stage_scaled_at_standstill_ends_at_its_no_load_speed() {
        let mut plant = released(2e4);
        for _ in 0..2000 {
            plant.step(10.0, 1e-3).expect("a step");
        }
        // 20.8 V less what the friction of 4.3e-4 N m s/rad draws, over 0.24 V s/rad.
        let speed_rad_s = signal(&plant, "motor_velocity_rad_s");
        let want_rad_s = 10.0 * 0.5 / 0.24 / (0.24 + 4.3e-4 * 0.5 / 0.24);
        assert!((speed_rad_s - want_rad_s).abs() < 0.5, "{speed_rad_s} rad/s for {want_rad_s}");
        assert_eq!(signal(&plant, "commanded_torque_nm"), 10.0);
        assert!(signal(&plant, "motor_torque_nm") < 0.1);
        assert!((signal(&plant, "bus_voltage_v") - 48.0).abs() < 0.1);
    }

    #[test]
    fn a_step_in_parts_ends_where_the_whole_does() {
        let (mut whole, mut parts) = (released(2e4), released(2e4));
        for step in 0..50 {
            let torque_nm = if step % 7 < 4 { 6.0 } else { -3.0 };
            whole.step(torque_nm, 1e-3).expect("a step");
            for part_s in [2.5e-4, 1.3e-4, 6.2e-4] {
                parts.step(torque_nm, part_s).expect("a step");
            }
        }
        let [one, other] = [&whole, &parts].map(|plant| plant.positions().motor_position_rad);
        assert!((one - other).abs() < 1e-3 * one.abs(), "{one} and {other}");
    }

    #[test]
    fn what_is_no_torque_or_time_is_refused() {
        let mut plant = released(2e4);
        assert!(matches!(plant.step(f64::NAN, 1e-3), Err(PlantError::Torque { .. })));
        assert!(matches!(plant.step(1.0, -1e-3), Err(PlantError::Duration { .. })));
        let parameters = ElectricalParameters { pwm_hz: 1.0, ..ElectricalParameters::example() };
        let refused = ElectricalPlant::new(plant.plant, parameters, Box::new(Scaled), 1);
        assert!(matches!(refused.err(), Some(PlantError::Parameter(error)) if error.name == "pwm_hz"));
    }
}
