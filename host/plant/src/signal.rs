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

/// Prefix that marks a drive's signal among all signals of a run.
pub const DRIVE_PREFIX: &str = "drive.";

/// Columns that every record has, in their order: no plant's signal may have their names.
pub const FIXED_COLUMNS: [&str; 9] = [
    "time_s",
    "reference_rad",
    "load_position_rad",
    "motor_position_rad",
    "torque_nm",
    "telemetry_time_s",
    "motor_counts",
    "load_counts",
    "sent_reference_rad",
];

/// Checks that the signals of a plant fit into a record: not too many, and each name once.
pub(crate) fn validate_signals(signals: &[Signal]) -> Result<(), PlantError> {
    if signals.len() > MAX_SIGNALS {
        return Err(PlantError::TooManySignals { have: signals.len() });
    }
    for (at, Signal { name, .. }) in signals.iter().enumerate() {
        let is_fixed = FIXED_COLUMNS.contains(&&**name) || name.starts_with(DRIVE_PREFIX) || name.is_empty();
        if is_fixed || signals[..at].iter().any(|other| other.name == *name) {
            return Err(PlantError::SignalName { name: name.to_string() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_a_fixed_column_or_of_the_drive_is_refused() {
        let signals = |name: &'static str| [Signal::new("twist_rad", "rad"), Signal::new(name, "s")];
        for name in FIXED_COLUMNS.into_iter().chain(["drive.twist_rad", "twist_rad", ""]) {
            let error = validate_signals(&signals(name)).expect_err(name);
            assert!(matches!(error, PlantError::SignalName { name: refused } if refused == name), "{name}");
        }
        validate_signals(&signals("drive_time_s")).expect("a name of its own");
    }
}
