//! An angle that was probably not meant in radians.

use std::f64::consts::TAU;

use lashloop_plant::reference::Reference;

use super::Trap;
use super::facts::Facts;
use crate::scenario::error::ScenarioError;
use crate::scenario::reader::Number;

/// Largest plausible angle of the load. Angles in degrees, from 15 on, are beyond it.
const PLAUSIBLE_RAD: f64 = 2.0 * TAU;

pub(super) fn check(facts: &Facts<'_>) -> Vec<ScenarioError> {
    let ratio = facts.number("plant.reduction_ratio").map_or(1.0, |ratio| ratio.value.max(1.0));
    let implausible = |angle: &Number| {
        let side = if angle.path.contains(".motor_") { ratio } else { 1.0 };
        angle.value.abs() > side * PLAUSIBLE_RAD
    };
    let angles = facts.angles("reference").chain(facts.angles("plant.initial"));
    let mut errors: Vec<_> =
        angles.filter(|angle| implausible(angle)).map(|angle| angle.error(reason(angle.value))).collect();
    if let Reference::Table(table) = facts.reference
        && let farthest_rad = table.farthest_rad()
        && farthest_rad.abs() > PLAUSIBLE_RAD
    {
        errors.extend(facts.error_at("reference.file", reason(farthest_rad)));
    }
    errors
}

fn reason(angle_rad: f64) -> String {
    format!(
        "goes to {angle_rad} rad, which are {:.1} turns; {angle_rad} degrees are {:.4} rad; correct it, {}",
        angle_rad / TAU,
        angle_rad.to_radians(),
        Trap::LargeAngle.silenced()
    )
}
