//! A plant behind a bridge: what makes the torque decides whether the load arrives.

use tests::program;
use tests::records::Records;

/// A motor that makes 30 N m at standstill and turns at up to this speed in rad/s, with 48 V.
fn metrics(no_load_rad_s: f64, torque_source: &str) -> serde_json::Value {
    let torque_constant_nm_a = 48.0 / no_load_rad_s;
    let resistance_ohm = 48.0 * torque_constant_nm_a / 30.0;
    let settings = [
        format!("plant.electrical.torque_source={torque_source}"),
        format!("plant.electrical.torque_constant_nm_a={torque_constant_nm_a}"),
        format!("plant.electrical.resistance_ohm={resistance_ohm}"),
        format!("plant.electrical.inductance_h={}", resistance_ohm * 1e-3),
        "plant.electrical.sense_range_a=300".to_owned(),
        // The law plans with 0.6 of it, so with what the motor has.
        format!("controller.parameters.motor_speed_limit_rad_s={}", 1.6 * no_load_rad_s),
        "run.duration_s=4".to_owned(),
    ];
    let records = Records::new();
    let out = records.out();
    let mut arguments = vec!["run", "scenarios/shaft-bridge.toml", "--device", "inproc", "--out", &out];
    arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    let _ = program::run(arguments);
    records.summary()["metrics"].clone()
}

fn number(metrics: &serde_json::Value, name: &str) -> f64 {
    metrics[name].as_f64().unwrap_or(f64::NAN)
}

#[test]
fn a_drive_that_knows_its_motor_settles_at_every_no_load_speed() {
    for no_load_rad_s in [400.0, 200.0, 100.0] {
        for torque_source in ["voltage", "current"] {
            let metrics = metrics(no_load_rad_s, torque_source);
            let settled_s = number(&metrics, "settle_time_s");
            println!("{no_load_rad_s} rad/s, {torque_source}: settled after {settled_s} s");
            assert!(settled_s <= 1.4, "{no_load_rad_s} rad/s, {torque_source}: {metrics}");
            assert!(
                number(&metrics, "overshoot_rad") <= 0.005,
                "{no_load_rad_s} rad/s, {torque_source}: {metrics}"
            );
        }
    }
}

#[test]
fn a_duty_in_proportion_to_the_torque_overshoots_the_more_the_slower_the_motor() {
    let overshoots = [400.0, 200.0, 100.0].map(|no_load_rad_s| {
        let metrics = metrics(no_load_rad_s, "amplifier");
        let overshoot_rad = number(&metrics, "overshoot_rad");
        let settled_s = number(&metrics, "settle_time_s");
        println!(
            "{no_load_rad_s} rad/s, amplifier: settled after {settled_s} s, overshoot {overshoot_rad} rad"
        );
        overshoot_rad
    });
    let [fast, _, slow] = overshoots;
    assert!(overshoots.is_sorted() && fast < 0.005 && slow > 0.03, "{overshoots:?} rad");
}

/// The estimate of the gap needs the torque to 0.1 %: it is right where the current is measured, whatever its sensor shows at rest.
#[test]
fn the_gap_is_found_by_the_measured_current() {
    let metrics = metrics(200.0, "current");
    let error_rad = number(&metrics, "dead_zone_error_rad");
    assert!(error_rad.abs() <= 0.025, "{error_rad} rad");
}
