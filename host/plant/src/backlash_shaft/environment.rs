//! What changes while the plant runs: wear and load torque.

use crate::ParameterError;
use crate::error::within;

/// Gap and load torque, which may change at every step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Environment {
    /// j0 in rad, half the gap; it grows as gears wear.
    pub dead_zone_rad: f64,
    /// External torque T on the load in N m.
    pub load_torque_nm: f64,
}

impl Environment {
    /// Checks both values.
    ///
    /// # Errors
    /// Names the value outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("dead_zone_rad", self.dead_zone_rad, 1e-6, 10.0)?;
        within("load_torque_nm", self.load_torque_nm, -1e6, 1e6)
    }
}
