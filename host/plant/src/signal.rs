//! A named quantity with its unit: one column of a record.

use std::borrow::Cow;

use crate::PlantError;
use crate::limits::MAX_SIGNALS;

/// A quantity that a plant or a drive reports at every step.
#[derive(Debug, Clone, PartialEq, Eq, Hash, serde::Serialize)]
pub struct Signal {
    /// Name, unique among the signals of its source; it ends with the unit, such as `twist_rad`.
    pub name: Cow<'static, str>,
    /// Unit as an engineer writes it, such as `N m s/rad`; empty for a pure number.
    pub unit: Cow<'static, str>,
}

impl Signal {
    /// A signal whose name is known when the program is built.
    #[must_use]
    pub const fn new(name: &'static str, unit: &'static str) -> Self {
        Self { name: Cow::Borrowed(name), unit: Cow::Borrowed(unit) }
    }
}

/// Columns that every record has, so that no plant's signal may have their names.
const FIXED_COLUMNS: [&str; 6] =
    ["time_s", "reference_rad", "load_position_rad", "motor_position_rad", "torque_nm", "telemetry_time_s"];

/// Checks that the signals of a plant fit into a record: not too many, and each name once.
pub(crate) fn validate_signals(signals: &[Signal]) -> Result<(), PlantError> {
    if signals.len() > MAX_SIGNALS {
        return Err(PlantError::TooManySignals { have: signals.len() });
    }
    for (at, Signal { name, .. }) in signals.iter().enumerate() {
        let is_fixed = FIXED_COLUMNS.contains(&&**name) || name.starts_with("drive.") || name.is_empty();
        if is_fixed || signals[..at].iter().any(|other| other.name == *name) {
            return Err(PlantError::SignalName { name: name.to_string() });
        }
    }
    Ok(())
}
