//! An initial state that fits neither the gap nor the reference.

use lashloop_plant::reference::Reference;

use super::Trap;
use super::facts::Facts;
use crate::scenario::error::ScenarioError;

/// Twist beyond the gap that counts as rounding of the positions in the file.
const ROUNDING_RAD: f64 = 1e-3;

/// Distance to the first value of the reference that counts as on it: the band in which a load counts as settled.
const ON_REFERENCE_RAD: f64 = 0.05;

pub(super) fn check(facts: &Facts<'_>) -> Vec<ScenarioError> {
    twist(facts).into_iter().chain(distance(facts)).collect()
}

/// A twist beyond the gap loads the shaft before the first sample.
fn twist(facts: &Facts<'_>) -> Option<ScenarioError> {
    let load = facts.number("plant.initial.load_position_rad")?;
    let motor = facts.number("plant.initial.motor_position_rad")?;
    let ratio = facts.number("plant.reduction_ratio")?;
    let gap = facts.number("plant.dead_zone_rad")?;
    let fitting_rad = ratio.value * load.value;
    let twist_rad = motor.value - fitting_rad;
    if twist_rad.abs() <= gap.value + ROUNDING_RAD {
        return None;
    }
    let reason = format!(
        "leaves a twist of {twist_rad:.4} rad, beyond the gap of +-{} rad; set plant.initial.motor_position_rad = \
         {fitting_rad}, the reduction ratio times the load position, {}",
        gap.value,
        Trap::Start.silenced()
    );
    // The error names a key that the scenario gives: the others are defaults.
    let place = [motor, load, ratio].into_iter().find(|number| number.is_given).unwrap_or(motor);
    Some(place.error(reason))
}

/// A constant reference is regulation from the start to the reference, so the distance is the test. Every other reference
/// moves by itself, and a start away from it is a jump that no key gives.
fn distance(facts: &Facts<'_>) -> Option<ScenarioError> {
    if matches!(facts.reference, Reference::Constant { .. }) {
        return None;
    }
    let load = facts.number("plant.initial.load_position_rad")?;
    let first_rad = facts.reference.position_rad(0.0);
    if (load.value - first_rad).abs() <= ON_REFERENCE_RAD {
        return None;
    }
    let motor = facts.number("plant.reduction_ratio").map_or(String::new(), |ratio| {
        format!(" and plant.initial.motor_position_rad = {}", ratio.value * first_rad)
    });
    Some(load.error(format!(
        "is not where the reference starts, so the first torque is a jump; set plant.initial.load_position_rad = \
         {first_rad}{motor}, {}",
        Trap::Start.silenced()
    )))
}
