//! The parameters of bench mode. Only a drive with encoders and a power stage of its own offers them, after all others.

use super::pins::{PinHardware, PinReadings};
use crate::contact::{Contact, IndexInput};
use crate::direction::Direction;
use crate::law::ParameterError;
use crate::power_stage::{BridgeLimits, Modulation, PowerStageFault, StageChoice};
use crate::torque::{Motor, TorqueSource};

crate::choices! {
    /// Source of the samples, and with it the destination of the torque.
    pub enum SampleSource {
        /// HIL mode: encoder samples from the host, torque to the host.
        Link = "link",
        /// Bench mode: the encoders and the power stage of the drive.
        Pins = "pins",
    }
}

crate::parameters! {
    /// The parameters of bench mode.
    pub struct PinParameters {
        /// Source of the samples.
        sample_source: SampleSource = Link;
        /// Control steps for each `BenchSample`.
        bench_sample_every: U32 = 1 in 1..=1000, "";
        /// Direction of the motor encoder.
        motor_direction: Direction = Forward;
        /// Direction of the load encoder.
        load_direction: Direction = Forward;
        /// Direction of the power stage.
        torque_direction: Direction = Forward;
        /// Torque for a duty of 1 more than `duty_offset`. At the default no torque limit of a usual motor has a duty, so a
        /// host has to set it.
        torque_per_duty_nm: F32 = 1.0 in 1e-3..=1e5, "N m";
        /// Duty of no torque.
        duty_offset: F32 = 0.5 in 0.0..=1.0, "";
        /// Smallest duty of the amplifier.
        duty_min: F32 = 0.1 in 0.0..=1.0, "";
        /// Largest duty of the amplifier.
        duty_max: F32 = 0.9 in 0.0..=1.0, "";
        /// Largest plausible change of the twist since the start, at the motor. Beyond it an encoder is lost.
        twist_limit_rad: F32 = 10.0 in 1e-3..=1e5, "rad";
        /// Pulses on a channel of an encoder up to this length are noise. No longer filter passes the default speed limit of the
        /// motor.
        encoder_filter_ns: U32 = 35 in 0..=2666, "ns";
        /// What the outputs mean to the power stage.
        stage_mode: StageChoice = Board;
        /// Frequency of the pulse-width modulation.
        pwm_frequency_hz: U32 = 20_000 in 100..=20_000, "Hz";
        /// What makes the torque of a command.
        torque_source: TorqueSource = Amplifier;
        /// Resistance of the motor at a bridge, with that of the bridge.
        motor_resistance_ohm: F32 = 1.0 in 1e-3..=1e4, "Ohm";
        /// Inductance of the motor at a bridge.
        motor_inductance_h: F32 = 1e-3 in 1e-6..=10.0, "H";
        /// Torque constant of the motor at a bridge; that of its back-EMF is equal.
        torque_constant_nm_a: F32 = 0.1 in 1e-4..=1e3, "N m/A";
        /// Voltage of the bus of a bridge where nothing measures it.
        supply_v: F32 = 24.0 in 1.0..=1e3, "V";
        /// Current that takes the converter of the current sensor from the middle to its end.
        current_range_a: F32 = 10.0 in 0.01..=1e4, "A";
        /// Direction of the current sensor: whether it shows more for a positive duty.
        current_direction: Direction = Forward;
        /// Voltage of the bus at the end of its converter.
        supply_range_v: F32 = 60.0 in 1.0..=1e3, "V";
        /// Largest current of the motor, by command. Beyond 1.5 of it the drive switches the bridge off.
        current_limit_a: F32 = 5.0 in 0.01..=1e4, "A";
        /// Fastest change of the torque. At the default the torque limit changes sign in a period.
        torque_slew_nm_s: F32 = 1e9 in 1e-3..=1e9, "N m/s";
        /// Least position of the motor.
        motor_travel_min_rad: F32 = -1e9 in -1e9..=1e9, "rad";
        /// Largest position of the motor.
        motor_travel_max_rad: F32 = 1e9 in -1e9..=1e9, "rad";
        /// Least position of the load.
        load_travel_min_rad: F32 = -1e9 in -1e9..=1e9, "rad";
        /// Largest position of the load.
        load_travel_max_rad: F32 = 1e9 in -1e9..=1e9, "rad";
        /// Longest time at 0.9 of the torque limit or more, in which neither encoder moves.
        stall_time_s: F32 = 0.5 in 0.001..=1e3, "s";
        /// Longest time in which the measured torque is less than half the command.
        missing_torque_time_s: F32 = 0.5 in 0.001..=1e3, "s";
        /// Torque that the motor bears forever.
        torque_continuous_nm: F32 = 1e5 in 1e-4..=1e5, "N m";
        /// Thermal time constant of the winding.
        motor_thermal_s: F32 = 30.0 in 0.01..=1e5, "s";
        /// Current that the bridge bears forever.
        current_continuous_a: F32 = 1e5 in 0.01..=1e5, "A";
        /// Thermal time constant of the bridge.
        stage_thermal_s: F32 = 1.0 in 0.01..=1e5, "s";
        /// Contact without which the drive neither arms nor runs.
        enable_input: Contact = Unused;
        /// Contact that ends a torque towards negative positions.
        negative_limit_input: Contact = Unused;
        /// Contact that ends a torque towards positive positions.
        positive_limit_input: Contact = Unused;
        /// Contact at the zero of both encoders.
        home_input: Contact = Unused;
        /// Encoder whose index pulse is at its zero; with `home_input`, the pulse while that contact is active.
        index_input: IndexInput = Unused;
        /// Smallest voltage of the bus. Below it, or below a fifth of `supply_v`, the drive switches the bridge off.
        supply_min_v: F32 = 0.0 in 0.0..=1e3, "V";
        /// Largest voltage of the bus. Beyond it, or at the end of its converter, the drive switches the bridge off.
        supply_max_v: F32 = 60.0 in 1.0..=1e3, "V";
        /// Voltage of the bus from which on a brake resistor is on, from the first run on and until 3 % less.
        brake_on_v: F32 = 1e3 in 1.0..=1e3, "V";
        /// Number of the rig, for hosts that compare it with their rig file.
        rig_id: U32 = 0 in 0..=4_294_967_295, "";
    }
}

impl PinParameters {
    /// The fault of a wired enable input that isn't active.
    pub(super) fn missing_enable(&self, readings: &PinReadings) -> Option<PowerStageFault> {
        let is_missing = self.enable_input.is_active(readings.contacts.enable) == Some(false);
        is_missing.then_some(PowerStageFault::NotEnabled)
    }

    /// From torque to duties, on a board with this hardware.
    ///
    /// # Errors
    /// The board doesn't have the mode of the power stage, or a sensor of the current.
    pub(super) fn modulation(&self, hardware: &PinHardware) -> Result<Modulation, ParameterError> {
        Ok(Modulation {
            mode: self.stage_mode.on(hardware.stage_modes)?,
            frequency_hz: self.pwm_frequency_hz,
            source: hardware.source(self.torque_source)?,
            motor: Motor {
                resistance_ohm: self.motor_resistance_ohm,
                inductance_h: self.motor_inductance_h,
                torque_constant_nm_a: self.torque_constant_nm_a,
            },
            bridge: BridgeLimits {
                supply_v: self.supply_v,
                current_range_a: self.current_range_a,
                current_direction: self.current_direction,
                supply_range_v: self.supply_range_v,
                current_limit_a: self.current_limit_a,
                supply_min_v: self.supply_min_v,
                supply_max_v: self.supply_max_v,
                brake_on_v: self.brake_on_v,
            },
            nm_per_full_duty: self.torque_per_duty_nm,
            offset: self.duty_offset,
            min: self.duty_min,
            max: self.duty_max,
            direction: self.torque_direction,
        })
    }
}
