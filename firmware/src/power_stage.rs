//! The power stage: from a torque to the duties of a pulse-width modulation, and what switches the bridge.
//!
//! The documented stage is a servo amplifier in torque mode, whose command input takes the duty: `offset` gives zero torque.
//! Many amplifiers take a duty near 0 or 1 for a broken wire, so the duty stays within `min` and `max`. Bridges have other
//! inputs: [`StageMode`] has them.

pub use crate::bridge_limits::{BridgeLimits, LARGEST_OFFSET, OVERCURRENT, PowerStageFault};
use crate::direction::Direction;
use crate::law::{ParameterError, ROUNDING, Real};
pub use crate::stage_mode::{StageChoice, StageMode};
use crate::torque::{BridgeReading, Motor, SensorCheck, TorqueControl, TorqueSource};

/// From a torque to the duties of both channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulation {
    /// What the channels mean.
    pub mode: StageMode,
    /// Frequency in Hz, 100 to 20,000.
    pub frequency_hz: u32,
    /// What makes the torque.
    pub source: TorqueSource,
    /// The motor at a bridge.
    pub motor: Motor,
    /// The bridge, where the drive makes the torque.
    pub bridge: BridgeLimits,
    /// Torque for a duty of 1 more than `offset`, in N m.
    pub nm_per_full_duty: f32,
    /// Duty of no torque, 0 to 1; 0 in a mode whose duty is the size of the torque.
    pub offset: f32,
    /// Smallest duty of the stage, 0 to `offset`.
    pub min: f32,
    /// Largest duty of the stage, `offset` to 1.
    pub max: f32,
    /// Whether a larger duty is a positive torque.
    pub direction: Direction,
}

/// Noise and steps of a current sensor, and what its check tolerates besides, as a part of range and limit.
const NOISE: f32 = 1.0 / 128.0;
const TOLERANCE: f32 = 0.1;

impl Modulation {
    /// Checks that every torque up to `torque_limit_nm`, in either direction, has a duty.
    ///
    /// # Errors
    /// The parameter beyond what the others allow.
    pub fn check(&self, torque_limit_nm: f32) -> Result<(), ParameterError> {
        if self.source != TorqueSource::Amplifier {
            return self.check_bridge(torque_limit_nm);
        }
        ParameterError::at_most("duty_min", self.min, self.offset, "duty_offset")?;
        ParameterError::at_most("duty_offset", self.offset, self.max, "duty_max")?;
        // Of any other offset these stages make a torque.
        let none = match self.mode {
            StageMode::Amplifier => self.offset,
            StageMode::Complementary => 0.5,
            StageMode::PwmDirection | StageMode::TwoPwmCoast | StageMode::TwoPwmBrake => 0.0,
        };
        if Real::abs(self.offset - none) > ROUNDING {
            let (value, max) = (self.offset, none);
            return Err(ParameterError { name: "duty_offset", value, max, given_by: "stage_mode" });
        }
        let largest_nm = self.largest_torque_nm() * (1.0 + ROUNDING);
        ParameterError::at_most("torque_limit_nm", torque_limit_nm, largest_nm, "the limits of the duty")
    }

    fn check_bridge(&self, torque_limit_nm: f32) -> Result<(), ParameterError> {
        let BridgeLimits { supply_v, current_range_a, current_limit_a, .. } = self.bridge;
        let Motor { resistance_ohm, torque_constant_nm_a, .. } = self.motor;
        // An amplifier has a current loop of its own. Between the pulses of a coasting motor no voltage is known.
        if matches!(self.mode, StageMode::Amplifier | StageMode::TwoPwmCoast) {
            let (value, max) = (self.source as u32 as f32, 0.0);
            return Err(ParameterError { name: "torque_source", value, max, given_by: "stage_mode" });
        }
        // Half-bridges that may not be high for longer than half a period have no voltage in either direction.
        if self.largest_duty() <= 0.0 {
            let (value, max) = (self.max, 1.0);
            return Err(ParameterError { name: "duty_max", value, max, given_by: "stage_mode" });
        }
        if self.source == TorqueSource::Current {
            // The sensor has to show the current that switches off.
            let largest_a = current_range_a * ((1.0 - LARGEST_OFFSET) / OVERCURRENT);
            ParameterError::at_most("current_limit_a", current_limit_a, largest_a, "current_range_a")?;
            let largest_nm = current_limit_a * torque_constant_nm_a * (1.0 + ROUNDING);
            return ParameterError::at_most(
                "torque_limit_nm",
                torque_limit_nm,
                largest_nm,
                "current_limit_a",
            );
        }
        let largest_nm =
            self.largest_duty() * supply_v / resistance_ohm * torque_constant_nm_a * (1.0 + ROUNDING);
        ParameterError::at_most("torque_limit_nm", torque_limit_nm, largest_nm, "the voltage at standstill")
    }

    /// Largest mean voltage of a bridge as a fraction of the bus.
    fn largest_duty(&self) -> f32 {
        if self.mode == StageMode::Complementary { 2.0 * self.max - 1.0 } else { self.max }
    }

    /// The control of the torque by the measured current.
    #[must_use]
    pub fn current_control(&self) -> TorqueControl {
        TorqueControl::by_current(self.motor, 1.0 / self.frequency_hz as f32, self.largest_duty())
    }

    /// The check of the sensor that measures the current.
    #[must_use]
    pub fn sensor_check(&self) -> SensorCheck {
        let BridgeLimits { current_range_a, current_limit_a, .. } = self.bridge;
        let period_s = 1.0 / self.frequency_hz as f32;
        SensorCheck::new(self.motor, period_s, NOISE * current_range_a, TOLERANCE * current_limit_a)
    }

    /// The high times of channels 1 and 2 for a mean voltage of a bridge as a fraction of the bus, -1 to 1.
    #[must_use]
    pub fn bridge_channels(&self, duty: f32) -> [f32; 2] {
        let largest = self.largest_duty();
        let duty = Real::clamp(self.direction.of_torque(duty), -largest, largest);
        let above_offset = if self.mode == StageMode::Complementary { 0.5 * duty } else { duty };
        self.of_mode(0.5 + above_offset, above_offset)
    }

    /// Largest torque in N m that has a duty in both directions.
    #[must_use]
    pub fn largest_torque_nm(&self) -> f32 {
        let (below, above) = (self.offset - self.min, self.max - self.offset);
        let is_smaller_below = below < above && !self.mode.is_of_size();
        self.nm_per_full_duty * if is_smaller_below { below } else { above }
    }

    /// The high times of channels 1 and 2 for a torque in N m at a speed of the motor in rad/s, 0 to 1. A torque that is not finite has
    /// the duty of no torque. Not for a torque that is made by the measured current.
    #[must_use]
    pub fn channels(&self, torque_nm: f32, speed_rad_s: f32) -> [f32; 2] {
        if self.source != TorqueSource::Amplifier {
            let reading = BridgeReading { current_a: 0.0, bus_v: self.bridge.supply_v };
            let mut control = TorqueControl::by_voltage(self.motor, self.largest_duty());
            return self.bridge_channels(control.duty(torque_nm, speed_rad_s, &reading));
        }
        let torque_nm = if torque_nm.is_finite() { self.direction.of_torque(torque_nm) } else { 0.0 };
        let above_offset = torque_nm / self.nm_per_full_duty;
        self.of_mode(Real::clamp(self.offset + above_offset, self.min, self.max), above_offset)
    }

    /// The channels for a duty of a stage with an offset, or a signed one of a stage without.
    fn of_mode(&self, duty: f32, above_offset: f32) -> [f32; 2] {
        let size = Real::clamp(Real::abs(above_offset), 0.0, self.max);
        let of_direction =
            |this: f32, other: f32| if above_offset < 0.0 { [other, this] } else { [this, other] };
        match self.mode {
            StageMode::Amplifier => [duty, 0.0],
            StageMode::PwmDirection => [size, if above_offset < 0.0 { 0.0 } else { 1.0 }],
            StageMode::TwoPwmCoast => of_direction(size, 0.0),
            StageMode::TwoPwmBrake => of_direction(1.0, 1.0 - size),
            StageMode::Complementary => [duty, 1.0 - duty],
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// 10 to 90 % for 8 N m in either direction.
    pub(crate) const AMPLIFIER: Modulation = Modulation {
        mode: StageMode::Amplifier,
        frequency_hz: 20_000,
        source: TorqueSource::Amplifier,
        motor: Motor { resistance_ohm: 0.5, inductance_h: 1e-3, torque_constant_nm_a: 0.25 },
        bridge: BridgeLimits {
            supply_v: 24.0,
            current_range_a: 80.0,
            current_direction: Direction::Forward,
            supply_range_v: 60.0,
            current_limit_a: 40.0,
            supply_min_v: 10.0,
            supply_max_v: 50.0,
            brake_on_v: 45.0,
        },
        nm_per_full_duty: 20.0,
        offset: 0.5,
        min: 0.1,
        max: 0.9,
        direction: Direction::Forward,
    };
    /// 95 % for 19 N m in either direction.
    const BRIDGE: Modulation =
        Modulation { mode: StageMode::PwmDirection, offset: 0.0, min: 0.0, max: 0.95, ..AMPLIFIER };

    fn near(have: f32, want: f32) {
        assert!((have - want).abs() < 1e-6, "have {have}, want {want}");
    }

    #[test]
    fn the_duty_is_the_offset_plus_the_torque_over_its_scale() {
        for (torque_nm, duty) in [(0.0, 0.5), (5.0, 0.75), (-5.0, 0.25), (8.0, 0.9), (-8.0, 0.1)] {
            near(AMPLIFIER.channels(torque_nm, 0.0)[0], duty);
            let reversed = Modulation { direction: Direction::Reverse, ..AMPLIFIER };
            near(reversed.channels(-torque_nm, 0.0)[0], duty);
        }
    }

    #[test]
    fn a_duty_stays_within_the_limits_of_the_amplifier() {
        for torque_nm in [9.0, 1e30, f32::MAX] {
            assert_eq!(
                [AMPLIFIER.channels(torque_nm, 0.0)[0], AMPLIFIER.channels(-torque_nm, 0.0)[0]],
                [0.9, 0.1]
            );
        }
    }

    #[test]
    fn a_torque_that_is_no_number_has_the_duty_of_no_torque() {
        for torque_nm in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(AMPLIFIER.channels(torque_nm, 0.0)[0], 0.5);
        }
    }

    #[test]
    fn an_offset_off_the_middle_leaves_the_smaller_side() {
        near(Modulation { offset: 0.4, ..AMPLIFIER }.largest_torque_nm(), 6.0);
        near(Modulation { offset: 0.7, ..AMPLIFIER }.largest_torque_nm(), 4.0);
    }

    #[test]
    fn a_torque_limit_without_a_duty_is_rejected_by_name() {
        assert_eq!(AMPLIFIER.check(8.0), Ok(()));
        let name = |modulation: Modulation, limit| modulation.check(limit).map_err(|error| error.name);
        assert_eq!(name(AMPLIFIER, 8.001), Err("torque_limit_nm"));
        assert_eq!(name(Modulation { min: 0.6, ..AMPLIFIER }, 0.0), Err("duty_min"));
        assert_eq!(name(Modulation { max: 0.4, ..AMPLIFIER }, 0.0), Err("duty_offset"));
    }

    #[test]
    fn rounding_rejects_no_limit_that_the_duty_just_reaches() {
        // In single precision 0.9 - 0.5 is less than 0.4.
        let modulation = Modulation { nm_per_full_duty: 50.0, ..AMPLIFIER };
        assert!(modulation.largest_torque_nm() < 20.0);
        assert_eq!(modulation.check(20.0), Ok(()));
    }

    #[test]
    fn every_mode_has_its_levels_for_either_direction_and_for_no_torque() {
        let modes = [
            (StageMode::PwmDirection, [0.25, 1.0], [0.25, 0.0], [0.0, 1.0]),
            (StageMode::TwoPwmCoast, [0.25, 0.0], [0.0, 0.25], [0.0, 0.0]),
            (StageMode::TwoPwmBrake, [1.0, 0.75], [0.75, 1.0], [1.0, 1.0]),
        ];
        for (mode, forward, backward, none) in modes {
            let bridge = Modulation { mode, ..BRIDGE };
            for (torque_nm, want) in [(5.0, forward), (-5.0, backward), (0.0, none), (f32::NAN, none)] {
                assert_eq!(bridge.channels(torque_nm, 0.0), want, "{mode:?}, {torque_nm} N m");
            }
            let reversed = Modulation { direction: Direction::Reverse, ..bridge };
            assert_eq!(
                [5.0, -5.0].map(|torque_nm| reversed.channels(torque_nm, 0.0)),
                [backward, forward],
                "{mode:?}"
            );
        }
        let halves = Modulation { mode: StageMode::Complementary, ..AMPLIFIER };
        assert_eq!(
            [5.0, -5.0, 0.0].map(|it| halves.channels(it, 0.0)),
            [[0.75, 0.25], [0.25, 0.75], [0.5, 0.5]]
        );
    }

    #[test]
    fn the_size_of_a_torque_has_the_whole_duty_and_needs_no_offset() {
        near(BRIDGE.largest_torque_nm(), 19.0);
        assert_eq!(BRIDGE.check(19.0), Ok(()));
        assert_eq!(BRIDGE.channels(100.0, 0.0), [0.95, 1.0]);
        let name = |modulation: Modulation| modulation.check(1.0).map_err(|error| error.name);
        assert_eq!(name(Modulation { offset: 0.1, ..BRIDGE }), Err("duty_offset"));
        let halves = Modulation { mode: StageMode::Complementary, ..AMPLIFIER };
        assert_eq!(name(halves), Ok(()));
        assert_eq!(
            name(Modulation { offset: 0.4, ..halves }),
            Err("duty_offset"),
            "voltage without a torque"
        );
        assert_eq!(name(Modulation { offset: 0.4, ..AMPLIFIER }), Ok(()));
        assert_eq!(BRIDGE.check(19.1).map_err(|error| error.name), Err("torque_limit_nm"));
    }

    /// A motor with 0.5 Ohm and 0.25 N m/A at 24 V.
    const BY_VOLTAGE: Modulation = Modulation {
        source: TorqueSource::Voltage,
        mode: StageMode::PwmDirection,
        min: 0.0,
        max: 1.0,
        ..AMPLIFIER
    };

    #[test]
    fn a_voltage_is_that_of_the_torque_and_of_the_speed() {
        // 2.4 N m are 9.6 A and 4.8 V of 24; 48 rad/s are 12 V.
        for (torque_nm, speed_rad_s, want) in [
            (2.4, 0.0, [0.2, 1.0]),
            (-2.4, 0.0, [0.2, 0.0]),
            (2.4, 48.0, [0.7, 1.0]),
            (100.0, 0.0, [1.0, 1.0]),
        ] {
            let have = BY_VOLTAGE.channels(torque_nm, speed_rad_s);
            assert!(
                have.iter().zip(want).all(|(have, want): (&f32, f32)| (have - want).abs() < 1e-6),
                "{have:?}"
            );
        }
        let halves = Modulation { mode: StageMode::Complementary, ..BY_VOLTAGE };
        near(halves.channels(2.4, 0.0)[0], 0.6);
        near(halves.channels(2.4, 0.0)[1], 0.4);
        let reversed = Modulation { direction: Direction::Reverse, ..BY_VOLTAGE };
        assert_eq!(reversed.channels(2.4, 0.0)[1], 0.0);
        assert_eq!(BY_VOLTAGE.channels(f32::NAN, 0.0)[0], 0.0);
    }

    #[test]
    fn a_bridge_needs_a_known_voltage_and_a_current_that_its_sensor_shows() {
        let by_current = Modulation { source: TorqueSource::Current, ..BY_VOLTAGE };
        let name = |modulation: Modulation, limit_nm| modulation.check(limit_nm).map_err(|error| error.name);
        // 24 V at standstill: 48 A, 12 N m. 40 A: 10 N m.
        assert_eq!((name(BY_VOLTAGE, 12.0), name(by_current, 10.0)), (Ok(()), Ok(())));
        assert_eq!(name(BY_VOLTAGE, 12.1), Err("torque_limit_nm"));
        assert_eq!(name(by_current, 10.1), Err("torque_limit_nm"));
        for modulation in [BY_VOLTAGE, by_current] {
            let at_amplifier = Modulation { mode: StageMode::Amplifier, ..modulation };
            assert_eq!(name(at_amplifier, 1.0), Err("torque_source"));
        }
        let coasting = |it: Modulation| Modulation { mode: StageMode::TwoPwmCoast, ..it };
        let both = [BY_VOLTAGE, by_current].map(|it| name(coasting(it), 1.0));
        assert_eq!(both, [Err("torque_source"); 2]);
        let halves = Modulation { mode: StageMode::Complementary, max: 0.3, ..by_current };
        assert_eq!(name(halves, 1.0), Err("duty_max"));
        let bridge = BridgeLimits { current_limit_a: 48.1, ..by_current.bridge };
        assert_eq!(name(Modulation { bridge, ..by_current }, 1.0), Err("current_limit_a"));
    }
}
