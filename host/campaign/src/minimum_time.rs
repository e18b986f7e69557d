//! The shortest settling time of a case's own plant.

use lashloop_bench::scenario::Scenario;
use lashloop_plant::Start;
use lashloop_plant::backlash_shaft::{self, BacklashShaft};
use lashloop_plant::reference::Reference;

use crate::campaign::Campaign;
use crate::cell::CaseNumbers;
use crate::plan::Case;
use crate::settings::Divisor;

impl CaseNumbers for (&Campaign, &Case) {
    fn number(&self, key: &str) -> Option<f64> {
        self.0.number(self.1, key)
    }

    fn quantity(&self, divisor: Divisor) -> Option<f64> {
        match divisor {
            Divisor::MinimumSettleTime => minimum_settle_time_s(&self.0.scenario(self.1).ok()?),
        }
    }
}

/// The minimum of `settle_time_s` in s; `None` for a scenario without one, see [`Divisor`].
fn minimum_settle_time_s(scenario: &Scenario) -> Option<f64> {
    let (plant, line) = (&scenario.plant, &scenario.line);
    let Reference::Constant { position_rad } = scenario.reference else { return None };
    let Start { load_position_rad, load_velocity_rad_s, motor_velocity_rad_s, .. } = plant.initial;
    let disturbed = plant.environment.as_ref().is_some_and(|environment| !environment.is_absent());
    if plant.model.name() != backlash_shaft::NAME
        || plant.electrical.is_some()
        || disturbed
        || [load_velocity_rad_s, motor_velocity_rad_s] != [0.0; 2]
    {
        return None;
    }
    let shaft = BacklashShaft::of(&plant.with(&plant.values, scenario.run.control_period_s())).ok()?;
    let delay_s = f64::from(plant.torque_delay_us() + line.delay_us) / 1e6;
    shaft.minimum_settle_time_s(position_rad - load_position_rad, delay_s)
}
