//! A first reach with the gains that follow from the estimates, as settings of a scenario.

use std::fmt::Write as _;

use lashloop_identify::Identified;
use lashloop_identify::excitation::Limits;
use lashloop_plant::backlash_shaft;

use super::files::{DriveParameter, DriveUse, drive_parameters};

/// The reach as a scenario.
pub const REACH_FILE: &str = "reach.toml";
/// The law, whose gains follow from the mechanics.
pub const LAW: &str = "braking-curve";

const DURATION_S: f64 = 15.0;
/// The move, as a fraction of the travel of the motions.
const MOVE: f64 = 0.5;
/// Largest settling time relative to the one that is expected, and what is added for a short one.
const LATER: f64 = 1.3;
const LATER_S: f64 = 0.1;

/// The settings of a scenario for a reach from rest, without expectations. The plant is the estimated one, whatever the
/// scenario has.
#[must_use]
pub fn settings(
    identified: &Identified,
    of: DriveUse,
    limits: &Limits,
    offers: impl Fn(&str) -> bool,
) -> Vec<String> {
    let mut plant = format!("plant={{ model = '{}'", backlash_shaft::NAME);
    let mut number = |key: &str, value: f64| {
        let _ = write!(plant, ", {key} = {value:?}");
    };
    for quantity in &identified.quantities {
        if let Some((key, value)) = quantity.plant_key.zip(identified.likely(quantity.name)) {
            number(key, value);
        }
    }
    let delay_us = identified.instruments.torque_delay_us;
    let _ = write!(
        plant,
        ", torque_delay_us = {delay_us}, initial = {{ load_position_rad = 0.0, motor_position_rad = 0.0 }} }}"
    );
    let limits_of_drive = [
        ("torque_limit_nm", limits.torque_nm),
        ("motor_speed_limit_rad_s", limits.motor_speed_rad_s),
        ("load_speed_limit_rad_s", limits.load_speed_rad_s),
    ];
    let limits_of_drive = limits_of_drive.map(|(name, value)| (name, format!("{value:?}")));
    let estimated = drive_parameters(identified, of).into_iter().filter(|it| it.lasts && offers(it.name));
    let estimated = estimated.map(|DriveParameter { name, value, .. }| (name, value));
    let parameters = limits_of_drive.into_iter().chain(estimated);
    let parameters = parameters.map(|(name, value)| format!("controller.parameters.{name}={value}"));
    let position_rad = MOVE * limits.load_travel_rad;
    let rest = [
        "title=First reach with the gains of the estimates".to_owned(),
        format!("run.duration_s={DURATION_S:?}"),
        plant,
        "controller={}".to_owned(),
        format!("controller.name={LAW}"),
        "bench.start=initial".to_owned(),
        format!("reference={{ profile = 'constant', position_rad = {position_rad:?} }}"),
        "expect=[]".to_owned(),
        "fault=[]".to_owned(),
        r#"meant=["start", "mismatch", "large-angle"]"#.to_owned(),
    ];
    rest.into_iter().chain(parameters).collect()
}

/// What the reach has to meet, after a simulation that settles in this time.
#[must_use]
pub fn expectations(settle_time_s: f64, resolution_rad: f64) -> String {
    let most_s = LATER * settle_time_s + LATER_S;
    let hunting_rad = 2.0 * resolution_rad;
    format!(
        "expect=[{{ metric = 'settle_time_5pct_s', unit = 's', max = {most_s:.3}, note = 'simulated on the estimates: {settle_time_s:.3} s' }}, \
         {{ metric = 'hunting_rad', unit = 'rad', max = {hunting_rad:?}, note = 'two counts' }}]"
    )
}
