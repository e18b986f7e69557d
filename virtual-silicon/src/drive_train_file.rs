//! A drive train from its description in JSON.
//!
//! ```json
//! {
//!   "model": "smooth",
//!   "values": { "dead_zone_rad": 0.2 },
//!   "start": { "motor_position_rad": 0.0, "load_position_rad": 0.0 },
//!   "period_s": 0.001,
//!   "scales": { "nm_per_full_duty": 30.0, "motor_counts_per_rev": 8192.0, "load_counts_per_rev": 8192.0 }
//! }
//! ```
//!
//! `values` are keys of the plant as in a scenario, with their defaults; `start` has velocities too, 0 if absent.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use lashloop_plant::electrical::ElectricalParameters;
use lashloop_plant::{Key, KeyKind, PlantValue, PlantValues, Plants, Release, Start};
use serde::Deserialize;
use serde_json::Value;

use crate::drive_train::{DriveTrain, Scales};
use crate::motor_at_bridge::{BridgeInputs, MotorAtBridge};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    model: String,
    #[serde(default)]
    values: BTreeMap<String, Value>,
    start: Released,
    period_s: f64,
    electrical: Option<Electrical>,
    scales: Scales,
}

/// A motor at the bridge.
#[derive(Deserialize)]
struct Electrical {
    inputs: BridgeInputs,
    bus_range_v: f64,
    seed: u64,
    /// Keys of a scenario's section `[plant.electrical]`.
    #[serde(flatten)]
    values: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Released {
    motor_position_rad: f64,
    load_position_rad: f64,
    #[serde(default)]
    motor_velocity_rad_s: f64,
    #[serde(default)]
    load_velocity_rad_s: f64,
}

/// Builds the drive train of a description.
///
/// # Errors
/// The description isn't JSON of this form, names a plant or key that doesn't exist, or a value is outside its range.
pub fn read(text: &str) -> Result<DriveTrain> {
    let Description { model, values, start, period_s, electrical, scales } =
        serde_json::from_str(text).context("not the description of a drive train")?;
    let Released { motor_position_rad, load_position_rad, motor_velocity_rad_s, load_velocity_rad_s } = start;
    let makes_torque = electrical.is_none().then_some(("scales.nm_per_full_duty", scales.nm_per_full_duty));
    for (name, value) in makes_torque.into_iter().chain([
        ("scales.motor_counts_per_rev", scales.motor_counts_per_rev),
        ("scales.load_counts_per_rev", scales.load_counts_per_rev),
        ("period_s", period_s),
    ]) {
        ensure!(value.is_finite() && value > 0.0, "{name} is {value}, expected a number above 0");
    }
    let plants = Plants::standard();
    let model = plants.get(&model).with_context(|| format!("no plant model is called {model}"))?;
    let mut plant_values = model.defaults();
    take(&mut plant_values, model.keys(), model.name(), &values)?;
    let start = Start { load_position_rad, load_velocity_rad_s, motor_position_rad, motor_velocity_rad_s };
    let release = Release { values: &plant_values, start, period_s, folder: Path::new("") };
    let train = DriveTrain::new(model.release(&release).context("the plant can't be built")?, scales);
    let Some(Electrical { inputs, bus_range_v, seed, values }) = electrical else { return Ok(train) };
    ensure!(
        bus_range_v.is_finite() && bus_range_v > 0.0,
        "electrical.bus_range_v is {bus_range_v}, expected a number above 0"
    );
    let keys = lashloop_plant::electrical::keys();
    let mut all = PlantValues::default();
    for key in &keys {
        if let Some(value) = key.default_value() {
            all.insert(key.name, value);
        }
    }
    take(&mut all, &keys, "motor at the bridge", &values)?;
    let parameters = ElectricalParameters::of_all(&all)?;
    parameters.validate()?;
    Ok(train.behind_motor(MotorAtBridge::new(parameters, inputs, bus_range_v, seed)))
}

/// Takes the given values of these keys.
fn take(all: &mut PlantValues, keys: &[Key], owner: &str, given: &BTreeMap<String, Value>) -> Result<()> {
    for (name, value) in given {
        let key = keys.iter().find(|key| key.name == *name);
        let key = key.with_context(|| format!("the plant {owner} has no key {name}"))?;
        insert(all, key, value)?;
    }
    Ok(())
}

fn insert(values: &mut PlantValues, key: &Key, value: &Value) -> Result<()> {
    let converted = match key.kind {
        KeyKind::Number { .. } => value.as_f64().map(PlantValue::Number),
        KeyKind::Integer { .. } => value.as_i64().map(PlantValue::Integer),
        KeyKind::Choice(_) => value.as_str().map(|text| PlantValue::Text(text.to_owned())),
        // Those of the plant in another process, which has no place in lockstep with the chip.
        KeyKind::Text { .. } | KeyKind::Texts { .. } | KeyKind::Table => None,
    };
    values.insert(key.name, converted.with_context(|| format!("{} can't be {value}", key.name))?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wiring::Encoder;

    const TEXT: &str = r#"{
        "model": "smooth", "values": { "dead_zone_rad": 0.2 }, "period_s": 0.001,
        "start": { "motor_position_rad": 3.141592653589793, "load_position_rad": -0.1 },
        "scales": { "nm_per_full_duty": 30, "motor_counts_per_rev": 8192, "load_counts_per_rev": 4096 }
    }"#;

    fn problem(text: &str) -> String {
        format!("{:#}", read(text).err().expect("an error"))
    }

    #[test]
    fn encoders_start_at_the_counts_of_their_positions() {
        let train = read(TEXT).unwrap();
        assert_eq!((train.count(Encoder::Motor), train.count(Encoder::Load)), (4096, -66));
    }

    #[test]
    fn a_motor_at_the_bridge_makes_the_torque_and_needs_no_scale() {
        let motor = r#""electrical": { "inputs": "halves", "bus_range_v": 60, "seed": 1, "supply_v": 24, "sense_bits": 10 },
            "scales": { "motor_counts_per_rev": 8192,"#;
        let text =
            TEXT.replace(r#""scales": { "nm_per_full_duty": 30, "motor_counts_per_rev": 8192,"#, motor);
        let mut train = read(&text).unwrap();
        let parameters = *train.motor_at_bridge().expect("a motor").circuit().parameters();
        assert_eq!((parameters.supply_v, parameters.sense_bits, parameters.inductance_h), (24.0, 10, 5e-4));
        assert!(problem(&text.replace("supply_v", "volts")).contains("motor at the bridge has no key volts"));
        assert!(problem(&text.replace("24", "-24")).contains("supply_v"));
        assert!(problem(&text.replace("60", "0")).contains("electrical.bus_range_v is 0"));
        assert!(problem(&text.replace("halves", "thirds")).contains("thirds"));
    }

    #[test]
    fn a_wrong_description_is_rejected_by_name() {
        assert!(problem(&TEXT.replace("smooth", "rough")).contains("no plant model is called rough"));
        assert!(problem(&TEXT.replace("dead_zone_rad", "zone")).contains("the plant smooth has no key zone"));
        assert!(problem(&TEXT.replace("0.2", "true")).contains("dead_zone_rad can't be true"));
        assert!(problem(&TEXT.replace("0.2", "-1")).contains("dead_zone_rad"));
        assert!(problem(&TEXT.replace("30", "0")).contains("nm_per_full_duty is 0"));
        assert!(problem(&TEXT.replace("start", "begin")).contains("unknown field `begin`"));
    }
}
