//! The scenario of a motion.

use std::fs;
use std::io;
use std::path::Path;

use lashloop_identify::excitation::Limits;

/// The law that commands the reference as a torque.
pub const LAW: &str = "open-loop";

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
    let parameters = parameters.map(|(name, value)| format!("{name} = {value:?}")).join(", ");
    vec![
        format!("controller.name={LAW}"),
        format!("controller.parameters={{ {parameters}, torque_per_rad_nm = 1.0 }}"),
        r#"meant=["start", "mismatch", "large-angle"]"#.to_owned(),
        "expect=[]".to_owned(),
        "fault=[]".to_owned(),
    ]
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
