//! A first reach with the gains that follow from the estimates, as settings of a scenario.

use std::fmt::Write as _;

use lashloop_bench::scenario::Scenario;
use lashloop_identify::excitation::Limits;
use lashloop_identify::{Direction, Identified};
use lashloop_plant::backlash_shaft;

use super::files::{DriveParameter, DriveUse, drive_parameters};

/// The reach as a scenario.
pub const REACH_FILE: &str = "reach.toml";
/// The law, whose gains follow from the mechanics.
pub const LAW: &str = "braking-curve";

/// Hunting is that of the last 10 s, so a reach of 15 s has come to rest.
const DURATION_S: f64 = 25.0;
/// The move, as a fraction of the travel of the motions.
const MOVE: f64 = 0.5;
/// Largest commanded speed of the load, as a fraction of the limit that ends a run.
const SPEED: f64 = 0.8;
/// Limit of the twist over what winds the shaft.
const TWIST: f64 = 2.0;
/// Largest settling time relative to the one that is expected, and what is added for a short one.
const LATER: f64 = 1.3;
const LATER_S: f64 = 0.1;

/// The reach of a machine.
pub struct FirstReach<'a> {
    /// What is known of it.
    pub identified: &'a Identified,
    /// How its drive is used.
    pub of: DriveUse,
    /// The limits of the motions.
    pub limits: &'a Limits,
    /// The parameters that the drive has.
    pub offers: &'a dyn Fn(&str) -> bool,
}

impl FirstReach<'_> {
    /// Distance of the move in rad.
    #[must_use]
    pub fn distance_rad(&self) -> f64 {
        MOVE * self.limits.load_travel_rad
    }

    /// For a simulation in HIL mode: the estimated plant, at rest in the middle of its gap, and encoders as they are given.
    #[must_use]
    pub fn simulated(&self) -> Vec<String> {
        let instruments = &self.identified.instruments;
        let delay = format!(", torque_delay_us = {}", instruments.torque_delay_us);
        let encoders = format!(
            "encoders={{ motor_counts_per_rev = {}, load_counts_per_rev = {}, noise_counts = {:?} }}",
            instruments.motor_counts_per_rev, instruments.load_counts_per_rev, instruments.noise_counts
        );
        let more = ["run.mode=hil".to_owned(), self.plant(&delay), encoders];
        self.common(0.0).into_iter().chain(more).collect()
    }

    /// For the drive itself. In HIL mode the plant is that of the scenario; in bench mode it is at the pins, and the estimated
    /// one is its model.
    #[must_use]
    pub fn of_drive(&self, scenario: &Scenario) -> Vec<String> {
        if self.of.mode.is_hil() {
            return self.common(scenario.plant.initial.load_position_rad);
        }
        let mechanics = &self.identified.mechanics;
        let wound_rad = self.limits.torque_nm / mechanics.stiffness_nm_rad + mechanics.dead_zone_rad;
        let directions = [
            ("motor_direction", self.identified.directions.motor),
            ("load_direction", self.identified.directions.load),
        ];
        let directions = directions.into_iter().filter_map(|(key, direction)| {
            let word = match direction? {
                Direction::Forward => "forward",
                Direction::Reverse => "reverse",
            };
            Some(format!("bench.{key}={word}"))
        });
        let bench = [
            self.plant(""),
            "bench.start=initial".to_owned(),
            format!("bench.load_travel_limit_rad={:?}", self.limits.load_travel_rad),
            format!("bench.twist_limit_rad={:?}", TWIST * wound_rad),
        ];
        self.common(0.0).into_iter().chain(bench).chain(directions).collect()
    }

    fn plant(&self, more: &str) -> String {
        let mut plant = format!("plant={{ model = '{}'", backlash_shaft::NAME);
        for quantity in &self.identified.quantities {
            if let Some((key, value)) = quantity.plant_key.zip(self.identified.likely(quantity.name)) {
                let _ = write!(plant, ", {key} = {value:?}");
            }
        }
        plant + more + ", initial = { load_position_rad = 0.0, motor_position_rad = 0.0 } }"
    }

    fn common(&self, from_rad: f64) -> Vec<String> {
        let Limits { torque_nm, motor_speed_rad_s, load_speed_rad_s, .. } = *self.limits;
        let limits = [
            ("torque_limit_nm", torque_nm),
            ("motor_speed_limit_rad_s", motor_speed_rad_s),
            ("load_speed_limit_rad_s", load_speed_rad_s),
            ("top_speed_rad_s", SPEED * load_speed_rad_s),
        ];
        let limits = limits.map(|(name, value)| (name, format!("{value:?}")));
        let estimated = drive_parameters(self.identified, self.of, self.offers).into_iter();
        let estimated = estimated.filter(|it| it.lasts && (self.offers)(it.name));
        let estimated = estimated.map(|DriveParameter { name, value, .. }| (name, value));
        let parameters = limits.into_iter().chain(estimated);
        let parameters = parameters.map(|(name, value)| format!("controller.parameters.{name}={value}"));
        let position_rad = from_rad + self.distance_rad();
        let rest = [
            "title=First reach with the gains of the estimates".to_owned(),
            format!("run.duration_s={DURATION_S:?}"),
            format!("controller.name={LAW}"),
            format!("reference={{ profile = 'constant', position_rad = {position_rad:?} }}"),
            "expect=[]".to_owned(),
            "fault=[]".to_owned(),
            r#"meant=["start", "mismatch", "large-angle"]"#.to_owned(),
        ];
        rest.into_iter().chain(parameters).collect()
    }
}

/// What the reach has to meet, after a simulation that settles in this time.
#[must_use]
pub fn expectations(settle_time_s: f64, rest_rad: f64) -> String {
    let most_s = LATER * settle_time_s + LATER_S;
    format!(
        "expect=[{{ metric = 'settle_time_5pct_s', unit = 's', max = {most_s:.3}, note = 'simulated on the estimates: {settle_time_s:.3} s' }}, \
         {{ metric = 'hunting_rad', unit = 'rad', max = {rest_rad:?}, note = 'two counts, and noise' }}]"
    )
}
