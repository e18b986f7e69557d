//! What ends a run at a bridge: its faults, and the limits of its sensors.

use crate::direction::Direction;
use crate::law::Real;
use crate::torque::BridgeReading;

/// What a power stage reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerStageFault {
    /// The break input of the timer switched the outputs off.
    BreakInput = 1,
    /// The fault line of the bridge or amplifier is active.
    FaultLine = 2,
    /// The bridge has no supply, or too little, or its driver doesn't answer.
    NoSupply = 3,
    /// A current of the bridge was too large.
    Overcurrent = 4,
    /// The bridge is too hot.
    Overtemperature = 5,
    /// The sensor of the current doesn't show the middle of its range while the bridge is off, or not the current that the voltage makes.
    CurrentSensor = 6,
    /// The voltage of the bus is too high.
    Overvoltage = 7,
    /// The contact of the enable input isn't active.
    NotEnabled = 8,
}

/// The drive switches a bridge off beyond this multiple of the largest current that a command may have.
pub const OVERCURRENT: f32 = 1.5;
/// A bus below this part of its nominal voltage is off, or nothing measures it.
const LEAST_SUPPLY: f32 = 0.2;
/// End of a converter of 12 bits, and a little less.
const LAST_CODE: f32 = 4094.9 / 4096.0;
/// Largest offset of a sensor that works, as a part of its range.
pub const LARGEST_OFFSET: f32 = 0.1;

/// What a bridge and its sensors can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BridgeLimits {
    /// Voltage of the bus, in V, where nothing measures it.
    pub supply_v: f32,
    /// Current in A that takes the converter from the middle to its end.
    pub current_range_a: f32,
    /// Whether the sensor shows more for a positive duty.
    pub current_direction: Direction,
    /// Voltage of the bus in V at the end of the converter.
    pub supply_range_v: f32,
    /// Largest current in A.
    pub current_limit_a: f32,
    /// Smallest voltage of the bus in V.
    pub supply_min_v: f32,
    /// Largest voltage of the bus in V.
    pub supply_max_v: f32,
    /// Voltage of the bus in V from which on a brake resistor is on.
    pub brake_on_v: f32,
}

impl BridgeLimits {
    /// What a reading shows that the bridge mustn't stay on for.
    #[must_use]
    pub fn fault(&self, reading: &BridgeReading) -> Option<PowerStageFault> {
        // The last code may be any voltage.
        let is_over = reading.bus_v > self.supply_max_v || reading.bus_v >= LAST_CODE * self.supply_range_v;
        let is_under = reading.bus_v < self.supply_min_v || reading.bus_v < LEAST_SUPPLY * self.supply_v;
        if Real::abs(reading.current_a) > OVERCURRENT * self.current_limit_a {
            Some(PowerStageFault::Overcurrent)
        } else if is_over {
            Some(PowerStageFault::Overvoltage)
        } else {
            is_under.then_some(PowerStageFault::NoSupply)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: BridgeLimits = BridgeLimits {
        supply_min_v: 10.0,
        supply_max_v: 50.0,
        ..crate::power_stage::tests::AMPLIFIER.bridge
    };

    #[test]
    fn a_reading_beyond_current_or_bus_is_a_fault() {
        use PowerStageFault::{NoSupply, Overcurrent, Overvoltage};
        let fault = |current_a, bus_v| LIMITS.fault(&BridgeReading { current_a, bus_v });
        assert_eq!([fault(60.0, 24.0), fault(-60.0, 50.0), fault(0.0, 10.0)], [None; 3]);
        assert_eq!([fault(60.1, 55.0), fault(-60.1, 0.0)], [Some(Overcurrent); 2]);
        assert_eq!((fault(0.0, 50.1), fault(0.0, 9.9)), (Some(Overvoltage), Some(NoSupply)));
        let unset = BridgeLimits { supply_min_v: 0.0, supply_max_v: 1e3, ..LIMITS };
        // The last of 4096 codes, and a fifth of 24 V.
        let fault = |bus_v| unset.fault(&BridgeReading { current_a: 0.0, bus_v });
        assert_eq!([fault(60.0 * 4094.0 / 4096.0), fault(60.0 * 4095.0 / 4096.0)], [None, Some(Overvoltage)]);
        assert_eq!([fault(4.81), fault(4.79)], [None, Some(NoSupply)]);
    }
}
