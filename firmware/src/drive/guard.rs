//! What ends a run of bench mode without a host: travel, stall, overload, a torque that is missing, limit switches.

use core::f32::consts::TAU;

use lashloop_protocol::enums::FaultCode;

use super::pin_parameters::PinParameters;
use super::pins::PinReadings;
use super::safety::Violation;
use crate::law::{DriveParameters, ParameterError, Real};
use crate::torque::TorqueSource;

/// Torque of a stall, as a fraction of the limit.
const STALL_TORQUE: f32 = 0.9;
/// Motion of a stalled motor, in counts.
const STALL_COUNTS: u32 = 4;
/// Smallest command that can be missing, as a fraction of the torque limit.
const MISSING_TORQUE: f32 = 0.1;

/// One run's limits and what they have seen.
pub(super) struct Guard {
    period_s: f32,
    torque_limit_nm: f32,
    motor_rad_per_count: f32,
    load_rad_per_count: f32,
    /// Counts of motor and load where they last moved.
    rest: [i32; 2],
    stalled_s: f32,
    missing_s: f32,
    /// Lagged square of the torque, in (N m)^2.
    motor_heat: f32,
    /// Lagged square of the current, in A^2.
    stage_heat: f32,
}

impl PinParameters {
    /// # Errors
    /// Limits of a travel that contain nothing.
    pub(super) fn check_travel(&self) -> Result<(), ParameterError> {
        let (motor, load) = ("motor_travel_min_rad", "load_travel_min_rad");
        ParameterError::at_most(motor, self.motor_travel_min_rad, self.motor_travel_max_rad, "its maximum")?;
        ParameterError::at_most(load, self.load_travel_min_rad, self.load_travel_max_rad, "its maximum")
    }
}

impl Guard {
    pub(super) fn new(drive: &DriveParameters) -> Self {
        Self {
            period_s: drive.period_s(),
            torque_limit_nm: drive.torque_limit_nm,
            motor_rad_per_count: TAU / drive.motor_counts_per_rev as f32,
            load_rad_per_count: TAU / drive.load_counts_per_rev as f32,
            rest: [0; 2],
            stalled_s: 0.0,
            missing_s: 0.0,
            motor_heat: 0.0,
            stage_heat: 0.0,
        }
    }

    /// Takes a control step: counts of motor and load without wraparound, the command of the last period, the torque that was, and the next command, in N m.
    ///
    /// # Errors
    /// The limit that doesn't hold.
    pub(super) fn check(
        &mut self,
        it: &PinParameters,
        counts: [i32; 2],
        readings: &PinReadings,
        [commanded_nm, torque_nm, next_nm]: [f32; 3],
    ) -> Result<(), Violation> {
        self.check_travel(it, counts)?;
        check_switches(it, readings, next_nm)?;
        self.check_stall(it, counts, torque_nm)?;
        self.check_heat(it, torque_nm)?;
        if readings.torque_nm.is_some() { self.check_torque(it, commanded_nm, torque_nm) } else { Ok(()) }
    }

    fn check_travel(&self, it: &PinParameters, [motor, load]: [i32; 2]) -> Result<(), Violation> {
        let motor_rad = motor as f32 * self.motor_rad_per_count;
        let load_rad = load as f32 * self.load_rad_per_count;
        within(FaultCode::MotorTravel, motor_rad, it.motor_travel_min_rad, it.motor_travel_max_rad)?;
        within(FaultCode::LoadTravel, load_rad, it.load_travel_min_rad, it.load_travel_max_rad)
    }

    fn check_stall(&mut self, it: &PinParameters, counts: [i32; 2], torque_nm: f32) -> Result<(), Violation> {
        let moved = |axis: usize| counts[axis].wrapping_sub(self.rest[axis]).unsigned_abs() > STALL_COUNTS;
        let has_moved = moved(0) || moved(1);
        if has_moved {
            self.rest = counts;
        }
        let is_at_limit = Real::abs(torque_nm) > STALL_TORQUE * self.torque_limit_nm;
        lasting(
            FaultCode::Stall,
            &mut self.stalled_s,
            is_at_limit && !has_moved,
            self.period_s,
            it.stall_time_s,
        )
    }

    /// The current loop holds its command, but where the voltage of the bus is at its end.
    fn check_torque(
        &mut self,
        it: &PinParameters,
        commanded_nm: f32,
        torque_nm: f32,
    ) -> Result<(), Violation> {
        let has_command = Real::abs(commanded_nm) > MISSING_TORQUE * self.torque_limit_nm;
        let along_nm = if commanded_nm < 0.0 { -torque_nm } else { torque_nm };
        let is_missing = has_command && along_nm < 0.5 * Real::abs(commanded_nm);
        let limit = it.missing_torque_time_s;
        lasting(FaultCode::TorqueMissing, &mut self.missing_s, is_missing, self.period_s, limit)
    }

    /// Heat follows the square of the torque behind the time constant of the winding, and of the current behind that of the stage.
    fn check_heat(&mut self, it: &PinParameters, torque_nm: f32) -> Result<(), Violation> {
        let period_s = self.period_s;
        let warm = |heat: &mut f32, square: f32, time_s: f32| {
            // At a time constant below a period the square itself.
            let part = period_s / if time_s > period_s { time_s } else { period_s };
            *heat += (square - *heat) * part;
            *heat
        };
        let motor = warm(&mut self.motor_heat, torque_nm * torque_nm, it.motor_thermal_s);
        overload(motor, it.torque_continuous_nm, 1)?;
        if it.torque_source == TorqueSource::Amplifier {
            return Ok(());
        }
        let current_a = torque_nm / it.torque_constant_nm_a;
        let stage = warm(&mut self.stage_heat, current_a * current_a, it.stage_thermal_s);
        overload(stage, it.current_continuous_a, 2)
    }
}

/// A torque away from a switch is allowed: the load has to come back.
fn check_switches(it: &PinParameters, readings: &PinReadings, next_nm: f32) -> Result<(), Violation> {
    let contacts = readings.contacts;
    let negative = it.negative_limit_input.is_active(contacts.negative_limit) == Some(true);
    let positive = it.positive_limit_input.is_active(contacts.positive_limit) == Some(true);
    let detail = match (negative && next_nm < 0.0, positive && next_nm > 0.0) {
        (false, false) => return Ok(()),
        (true, _) => 1,
        (false, true) => 2,
    };
    Err(Violation { detail, ..Violation::of(FaultCode::LimitSwitch) })
}

fn within(code: FaultCode, value: f32, min: f32, max: f32) -> Result<(), Violation> {
    let limit = if value < min { min } else { max };
    if value < min || value > max { Err(Violation { code, value, limit, detail: 0 }) } else { Ok(()) }
}

fn overload(heat: f32, limit: f32, detail: u32) -> Result<(), Violation> {
    if heat <= limit * limit {
        return Ok(());
    }
    Err(Violation { code: FaultCode::Overload, value: Real::sqrt(heat), limit, detail })
}

/// A condition that lasts longer than its limit, in seconds, is a fault.
fn lasting(
    code: FaultCode,
    lasted_s: &mut f32,
    holds: bool,
    period_s: f32,
    limit: f32,
) -> Result<(), Violation> {
    *lasted_s = if holds { *lasted_s + period_s } else { 0.0 };
    if *lasted_s <= limit { Ok(()) } else { Err(Violation { code, value: *lasted_s, limit, detail: 0 }) }
}
