//! The scenario of a motion.

use std::fs;
use std::io;
use std::path::Path;

use lashloop_bench::scenario::bench::{TORQUE_PER_RAD_NM, key_of_pin};
use lashloop_bench::scenario::controller::{ParameterSetting, ParameterValue};
use lashloop_bench::scenario::{Origin, RunMode, Scenario};
use lashloop_identify::excitation::Limits;

use lashloop::rig::drive_settings::COMMISSION;
use lashloop::rig::file::pin_default;

/// The law that commands the reference as a torque.
const LAW: &str = "open-loop";

/// Settings that make a commissioning of any scenario: the law, the limits as parameters of the drive, no expectation. The
/// mode, the encoders, the period and the plant of the scenario stay.
#[must_use]
pub fn settings(limits: &Limits) -> Vec<String> {
    let Limits { torque_nm, motor_speed_rad_s, load_speed_rad_s, .. } = limits;
    let parameters = [
        ("torque_limit_nm", torque_nm),
        ("motor_speed_limit_rad_s", motor_speed_rad_s),
        ("load_speed_limit_rad_s", load_speed_rad_s),
    ];
    // Those of the drive stay, such as the motor at its bridge; those of the law in the file are left out.
    let parameters = parameters.into_iter().chain([(TORQUE_PER_RAD_NM, &1.0)]);
    let parameters = parameters.map(|(name, value)| format!("controller.parameters.{name}={value:?}"));
    let rest = [
        format!("controller.name={LAW}"),
        // A motion begins where the one before has ended.
        "bench.start=anywhere".to_owned(),
        r#"meant=["start", "mismatch", "large-angle"]"#.to_owned(),
        "expect=[]".to_owned(),
        "fault=[]".to_owned(),
    ];
    rest.into_iter().chain(parameters).collect()
}

/// What a scenario gives a parameter of the drive.
pub(super) fn given<'a>(scenario: &'a Scenario, name: &str) -> Option<&'a ParameterValue> {
    let mut settings = scenario.controller.parameters.iter().chain(&scenario.bench.parameters);
    settings.find(|it| it.name == name).map(|it| &it.value)
}

/// The number that a scenario gives a parameter of the pins, else the drive's default.
#[must_use]
pub fn pin_number(scenario: &Scenario, name: &str) -> f64 {
    match given(scenario, name) {
        Some(ParameterValue::Number(number)) => *number,
        _ => pin_default(name),
    }
}

/// Gives a parameter of the pins a value instead of the scenario's, also instead of the rig's.
pub fn set_pin(scenario: &mut Scenario, name: &str, value: f64) {
    let Scenario { controller, bench, .. } = scenario;
    for of in [&mut controller.parameters, &mut bench.parameters] {
        of.retain(|it| it.name != name);
    }
    let (section, of) = match key_of_pin(name) {
        Some(_) => ("bench", &mut bench.parameters),
        None => ("controller.parameters", &mut controller.parameters),
    };
    let origin = Origin::Option(COMMISSION.into());
    of.push(ParameterSetting {
        section,
        name: name.to_owned(),
        value: ParameterValue::Number(value),
        origin,
    });
}

/// Parameter of a drive in bench mode: the change of the twist beyond which an encoder counts as lost.
const TWIST_LIMIT_RAD: &str = "twist_limit_rad";

/// Raises the limit of the twist to what a motion explains.
pub(super) fn explain_twist(scenario: &mut Scenario, twist_rad: Option<f64>) {
    let Some(explained_rad) = twist_rad.filter(|_| scenario.run.mode == RunMode::Bench) else { return };
    let parameters = &mut scenario.bench.parameters;
    let given_rad = match parameters.iter().find(|it| it.name == TWIST_LIMIT_RAD).map(|it| &it.value) {
        Some(ParameterValue::Number(limit_rad)) => *limit_rad,
        // It bounds the first motions, in which nothing is known but that the load barely moves.
        _ => pin_default(TWIST_LIMIT_RAD),
    };
    parameters.retain(|it| it.name != TWIST_LIMIT_RAD);
    parameters.push(ParameterSetting {
        section: "bench",
        name: TWIST_LIMIT_RAD.to_owned(),
        value: ParameterValue::Number(given_rad.max(explained_rad)),
        origin: Origin::Option(COMMISSION.into()),
    });
}

/// Settings of one motion: its duration, and its torques as the table of the reference.
pub(super) fn motion(torque_nm: &[f64], period_s: f64, table: &Path) -> io::Result<Vec<String>> {
    let mut text = "time_s,position_rad\n".to_owned();
    let mut before = None;
    for (at, torque_nm) in torque_nm.iter().enumerate() {
        if before != Some(torque_nm) {
            text += &format!("{:?},{torque_nm:?}\n", at as f64 * period_s);
        }
        before = Some(torque_nm);
    }
    fs::write(table, text)?;
    let file = table.display().to_string();
    Ok(vec![
        format!("run.duration_s={:?}", torque_nm.len() as f64 * period_s),
        format!("reference={{ profile = \"table\", interpolation = \"hold\", file = {file:?} }}"),
    ])
}
