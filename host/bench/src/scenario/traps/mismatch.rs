//! A plant that isn't the one which the drive's parameters describe.

use super::Trap;
use super::facts::Facts;
use crate::scenario::controller::ParameterValue;
use crate::scenario::error::ScenarioError;
use crate::scenario::reader::Number;

/// Keys of `[plant]` whose equals in the drive describe the same machine.
const COMPARED: [&str; 4] = ["reduction_ratio", "dead_zone_rad", "load_inertia_kg_m2", "motor_inertia_kg_m2"];

/// Relative difference up to which two numbers are one: a drive computes in single precision.
const SAME: f64 = 1e-5;

fn differ(one: f64, other: f64) -> bool {
    (one - other).abs() > SAME * one.abs().max(other.abs())
}

fn compared<'a>(facts: &'a Facts<'_>) -> impl Iterator<Item = (&'static str, &'a Number)> {
    COMPARED.into_iter().filter_map(|name| Some((name, facts.number(&format!("plant.{name}"))?)))
}

/// Compares the plant with the parameters that the scenario sets.
pub(super) fn check(facts: &Facts<'_>) -> Vec<ScenarioError> {
    let mut errors = Vec::new();
    for (name, plant) in compared(facts) {
        for setting in facts.parameters.iter().filter(|setting| setting.name == name) {
            let ParameterValue::Number(number) = setting.value else { continue };
            if differ(number, plant.value) {
                let reason = format!(
                    "is not {}, the value of {}; make them equal, {}",
                    plant.value,
                    plant.path,
                    Trap::Mismatch.silenced()
                );
                errors.push(ScenarioError::parameter(setting, reason));
            }
        }
    }
    errors
}

/// Whether a default of the drive can differ from the plant.
pub(super) fn depends_on_drive(facts: &Facts<'_>) -> bool {
    compared(facts).any(|(name, _)| facts.parameters.iter().all(|setting| setting.name != name))
}

/// Numbers of the plant that the drive's defaults must equal, because the scenario sets no such parameter.
#[derive(Debug, Clone, Default)]
pub(in crate::scenario) struct Nominal(Vec<(&'static str, Number)>);

/// Two scenarios are equal if their numbers are; their places in the file don't count.
impl PartialEq for Nominal {
    fn eq(&self, other: &Self) -> bool {
        let numbers = |nominal: &Self| -> Vec<_> {
            nominal.0.iter().map(|(name, number)| (*name, number.value)).collect()
        };
        numbers(self) == numbers(other)
    }
}

impl Nominal {
    /// The numbers that the scenario leaves to the drive's defaults.
    pub(in crate::scenario) fn new(facts: &Facts<'_>) -> Self {
        let left = |name: &str| facts.parameters.iter().all(|setting| setting.name != name);
        let left = compared(facts).filter(|(name, _)| left(name));
        Self(left.map(|(name, number)| (name, number.clone())).collect())
    }

    /// Errors for numbers that differ from the drive's. `default_of` gives the default of the drive's parameter of a name;
    /// `None` if the drive or its law has no such parameter.
    pub(in crate::scenario) fn check(&self, default_of: impl Fn(&str) -> Option<f64>) -> Vec<ScenarioError> {
        let mut errors = Vec::new();
        for (name, plant) in &self.0 {
            let Some(default) = default_of(name).filter(|default| differ(*default, plant.value)) else {
                continue;
            };
            // A drive has it in single precision: 0.16, and not 0.1599999964237213.
            let default = default as f32;
            errors.push(plant.error(format!(
                "is not the drive's default of {default}; set controller.parameters.{name} = {}, {}",
                plant.value,
                Trap::Mismatch.silenced()
            )));
        }
        errors
    }
}
