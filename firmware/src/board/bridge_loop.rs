//! The current loop of a bridge: the interrupt of its sensor, once in each period of the modulation.
//!
//! It preempts the tick. It never switches the bridge on.

use super::Fitted;
use super::bridge_exchange::{
    BridgeCommand, BridgeRun, COMMAND, FAULT, HAS_BUS, MEASURED, OFFSET_IS_PLAUSIBLE, RUN,
};
use super::chip::Chip;
use super::parts::{BridgeSensor, PwmTimer, StageLines};
use crate::law::Real;
use crate::power_stage::{LARGEST_OFFSET, PowerStageFault};
use crate::torque::{BridgeReading, SensorCheck, SensorOffset, TorqueControl};

type Sensor = <Fitted as Chip>::Sensor;

/// Steps of the converter, from the middle to its end.
const HALF_RANGE: f32 = 2048.0;
/// A bus below this code of the converter, a 64th of its range, has no voltage.
const LEAST_BUS: u16 = 64;
/// Periods from a bridge off to a motor without current.
const DECAY: u32 = 400;

/// The loop, for the task of the sensor.
pub struct BridgeLoop {
    sensor: Sensor,
    offset: SensorOffset,
    /// `None` while the bridge is off.
    control: Option<(TorqueControl, SensorCheck)>,
    /// Voltage of the bridge in this period, in V.
    voltage_v: f32,
    /// Periods until a bridge that is off has no current.
    decay: u32,
    /// Code of the bus above which the brake resistor is on, by the last run.
    brake_on: u16,
    is_braking: bool,
}

impl BridgeLoop {
    /// The loop of a sensor that measures from now on.
    pub(super) fn start(sensor: Sensor) -> Self {
        Sensor::listen(true);
        Self {
            sensor,
            offset: SensorOffset::default(),
            control: None,
            voltage_v: 0.0,
            decay: 0,
            brake_on: u16::MAX,
            is_braking: false,
        }
    }

    /// Takes the readings of a period and sets the duty of the next one. To be called once per interrupt.
    pub fn step(&mut self) {
        let [current, bus] = self.sensor.take();
        self.brake(bus);
        let (Some(run), Some(offset)) = (RUN.get(), self.offset.reading()) else {
            return self.rest(current, bus);
        };
        let BridgeRun { modulation, period_counts } = run;
        let bridge = &modulation.bridge;
        let above = (f32::from(current) - offset) * (bridge.current_range_a / HALF_RANGE);
        let current_a = bridge.current_direction.of_torque(modulation.direction.of_torque(above));
        let bus_v = f32::from(bus) * (bridge.supply_range_v / (2.0 * HALF_RANGE));
        let reading = BridgeReading { current_a, bus_v };
        self.brake_on = (bridge.brake_on_v * (2.0 * HALF_RANGE / bridge.supply_range_v)) as u16;
        let (control, check) =
            self.control.get_or_insert_with(|| (modulation.current_control(), modulation.sensor_check()));
        if let Some(fault) = bridge.fault(&reading) {
            return trip(fault);
        }
        let BridgeCommand { torque_nm, speed_rad_s } = COMMAND.get();
        let duty = control.duty(torque_nm, speed_rad_s, &reading);
        if check.step(torque_nm, speed_rad_s, &reading, duty) {
            return trip(PowerStageFault::CurrentSensor);
        }
        let [first, second] =
            modulation.bridge_channels(duty).map(|high| (high * f32::from(period_counts) + 0.5) as u16);
        <Fitted as Chip>::Pwm::set_high_from_any_code(first, second);
        let measured_nm = modulation.motor.torque_constant_nm_a * current_a;
        // The new duty takes effect half a period later: the middle of this period has the voltage of the last one.
        let voltage_v = core::mem::replace(&mut self.voltage_v, duty * bus_v);
        // No task of a higher priority takes the sums meanwhile.
        let ([sum_nm, sum_v], count) = MEASURED.get();
        MEASURED.set(([sum_nm + measured_nm, sum_v + voltage_v], count + 1));
    }

    /// Switches the brake resistor, also with the bridge off: a motor that is turned still feeds the bus.
    fn brake(&mut self, bus: u16) {
        // 3 % of hysteresis.
        let hysteresis = if self.is_braking { self.brake_on / 32 } else { 0 };
        self.is_braking = bus > self.brake_on - hysteresis;
        <Fitted as Chip>::StageLines::set_brake(self.is_braking);
    }

    /// A period with the bridge off.
    fn rest(&mut self, current: u16, bus: u16) {
        HAS_BUS.set(bus >= LEAST_BUS);
        self.voltage_v = 0.0;
        if self.control.take().is_some() {
            self.decay = DECAY;
        }
        if self.decay > 0 {
            self.decay -= 1;
            self.offset.restart();
            return;
        }
        self.offset.take(current.into());
        if let Some(offset) = self.offset.reading() {
            let is_plausible = Real::abs(offset - HALF_RANGE) <= LARGEST_OFFSET * HALF_RANGE;
            OFFSET_IS_PLAUSIBLE.set(Some(is_plausible));
        }
    }
}

/// Switches the bridge off for the rest of the run, whose first fault it is.
fn trip(fault: PowerStageFault) {
    <Fitted as Chip>::StageLines::switch_off();
    FAULT.set(Some(fault));
    RUN.set(None);
}
