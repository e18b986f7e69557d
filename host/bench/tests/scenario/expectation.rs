//! Expectations: what can be judged, and what a scenario can't measure.

use std::fmt::Write;

use lashloop_bench::scenario::Scenario;
use lashloop_plant::Signal;
use lashloop_plant::metrics::{Metric, Quantity, SignalTable, Statistic, Window};

use crate::{SHORTEST, read, set};

/// The shortest scenario with this expectation.
fn expecting(keys: &str) -> String {
    format!("{SHORTEST}[[expect]]\n{keys}\n")
}

/// A move of 1 rad that ends at 1.5 s, from where the load starts.
fn moving(keys: &str) -> String {
    let start = "model = \"smooth\"\ninitial = { load_position_rad = 0.0, motor_position_rad = 0.0 }";
    let profile = "profile = \"trapezoid\"\nfrom_rad = 0.0\nto_rad = 1.0\nvelocity_rad_s = 1.0\nacceleration_rad_s2 = 2.0";
    expecting(keys)
        .replace("model = \"smooth\"", start)
        .replace("profile = \"constant\"\nposition_rad = 0.0", profile)
}

/// Signals of a run on a plant with a gap, with a law that estimates it.
fn signals() -> SignalTable {
    SignalTable {
        plant: vec![Signal::new("twist_rad", "rad"), Signal::new("dead_zone_rad", "rad")],
        drive: vec![Signal::new("requested_torque_nm", "N m"), Signal::new("dead_zone_estimate_rad", "rad")],
    }
}

#[test]
fn a_signal_and_a_window_are_read_and_printed() {
    let text = expecting(
        "signal = \"drive.requested_torque_nm\"\nstatistic = \"peak_to_peak\"\nunit = \"N m\"\nmax = 3.0\nfrom_s = 0.5\nto_s = 1.5",
    );
    let scenario = read(&text, &[]).expect("a scenario");
    let query = scenario.expectations[0].query();
    assert_eq!(
        query.quantity,
        Quantity::Statistic {
            signal: "drive.requested_torque_nm".to_owned(),
            statistic: Statistic::PeakToPeak
        }
    );
    assert_eq!(query.window, Some(Window { from_s: 0.5, to_s: Some(1.5) }));
    let printed = scenario.to_toml().expect("TOML");
    assert_eq!(read(&printed, &[]).expect(&printed).expectations, scenario.expectations);
    scenario.check_expectations(&signals()).expect("a run that measures it");
}

#[test]
fn half_a_window_reaches_to_the_other_end_of_the_run() {
    let window = |keys: &str| {
        let text = expecting(&format!("metric = \"peak_torque_nm\"\nunit = \"N m\"\nmax = 3\n{keys}"));
        read(&text, &[]).expect(keys).expectations[0].window
    };
    assert_eq!(window(""), None);
    assert_eq!(window("from_s = 1"), Some(Window { from_s: 1.0, to_s: None }));
    assert_eq!(window("to_s = 1"), Some(Window { from_s: 0.0, to_s: Some(1.0) }));
    assert_eq!(window("to_s = 2"), Some(Window { from_s: 0.0, to_s: Some(2.0) }));
}

#[test]
fn every_statistic_and_every_metric_has_its_name() {
    for statistic in Statistic::ALL {
        let keys = format!("signal = \"torque_nm\"\nstatistic = \"{statistic}\"\nunit = \"N m\"\nmax = 3");
        let scenario =
            read(&expecting(&keys), &[]).unwrap_or_else(|errors| panic!("{}: {errors}", statistic.name()));
        let quantity = Quantity::Statistic { signal: "torque_nm".to_owned(), statistic };
        assert_eq!(scenario.expectations[0].quantity, quantity);
    }
    for metric in Metric::ALL {
        let keys = format!("metric = \"{metric}\"\nunit = \"{}\"\nmax = 3", metric.unit());
        // What this scenario can't measure is refused for that reason only.
        if let Err(message) = read(&expecting(&keys), &[]) {
            assert!(message.contains("needs a"), "{message}");
        }
    }
}

/// Keys of an expectation that reading rejects.
const WRONG: &[&str] = &[
    // What to judge.
    "max = 1",
    "signal = \"torque_nm\"\nunit = \"N m\"\nmax = 1",
    "statistic = \"rms\"\nunit = \"N m\"\nmax = 1",
    "metric = \"hunting_rad\"\nsignal = \"torque_nm\"\nunit = \"rad\"\nmax = 1",
    "metric = \"hunting_rad\"\nstatistic = \"rms\"\nunit = \"rad\"\nmax = 1",
    "signal = \"torque_nm\"\nstatistic = \"median\"\nunit = \"N m\"\nmax = 1",
    "signal = \"torque_nm\"\nstatistic = \"rms\"\nunit = \"Nm\"\nmax = 1",
    "signal = \"twist_rad\"\nstatistic = \"rms\"\nmax = 1",
    // Windows.
    "metric = \"peak_torque_nm\"\nunit = \"N m\"\nmax = 1\nfrom_s = 2",
    "metric = \"peak_torque_nm\"\nunit = \"N m\"\nmax = 1\nto_s = 2.1",
    "metric = \"peak_torque_nm\"\nunit = \"N m\"\nmax = 1\nfrom_s = 1.5\nto_s = 1",
    "metric = \"peak_torque_nm\"\nunit = \"N m\"\nmax = 1\nfrom_s = 1\nto_s = 1.0001",
    "metric = \"peak_torque_nm\"\nunit = \"N m\"\nmax = 1\nfrom_s = -1",
    "metric = \"static_error_rad\"\nunit = \"rad\"\nmax = 1\nfrom_s = 1.5",
    // Metrics that the run has no value for: 2 s along a constant reference.
    "metric = \"hunting_rad\"\nunit = \"rad\"\nmax = 1",
    "metric = \"lost_motion_rad\"\nunit = \"rad\"\nmax = 1",
    "metric = \"settle_after_move_s\"\nunit = \"s\"\nmax = 1",
    "metric = \"steady_velocity_error_rad\"\nunit = \"rad\"\nmax = 1",
    "metric = \"dead_zone_bias_rad\"\nunit = \"rad\"\nmax = 1",
    "signal = \"drive.load_error_rad\"\nstatistic = \"max\"\nunit = \"rad\"\nmax = 1\nfrom_s = 0.001\nto_s = 0.009",
];

#[test]
fn what_a_scenario_cannot_measure_is_refused_when_it_is_read() {
    let mut table = String::new();
    let mut row = |keys: &str, text: &str| {
        let messages = read(text, &[]).expect_err(keys);
        for line in keys.lines() {
            writeln!(table, "| {line}").expect("a String takes everything");
        }
        writeln!(table, "{messages}\n").expect("a String takes everything");
    };
    for keys in WRONG {
        row(keys, &expecting(keys));
    }
    for keys in [
        "metric = \"settle_time_2pct_s\"\nunit = \"s\"\nmax = 1",
        "metric = \"settle_after_move_s\"\nunit = \"s\"\nmax = 1\nto_s = 1.4",
        "metric = \"rise_time_s\"\nunit = \"s\"\nmax = 1\nto_s = 1.4",
    ] {
        row(keys, &moving(keys));
    }
    insta::assert_snapshot!(table);
}

#[test]
fn telemetry_that_is_off_measures_no_estimate() {
    let keys = "metric = \"dead_zone_error_rad\"\nunit = \"rad\"\nmax = 1";
    let off = format!("[telemetry]\nevery_steps = 0\n{}", "[controller]");
    let text = expecting(keys).replace("[controller]", &off);
    insta::assert_snapshot!(read(&text, &[]).expect_err("no telemetry"), @r#"
    x.toml:14: expect.0.metric: "dead_zone_error_rad" needs telemetry, but telemetry.every_steps is 0; set it to 1 or more
    "#);
}

#[test]
fn what_moves_can_be_measured_on_a_move() {
    for metric in [Metric::SettleAfterMove, Metric::RiseTime, Metric::SteadyVelocityError] {
        let text = moving(&format!("metric = \"{metric}\"\nunit = \"{}\"\nmax = 1", metric.unit()));
        read(&text, &[]).unwrap_or_else(|messages| panic!("{metric}: {messages}"));
    }
}

#[test]
fn an_option_that_shortens_the_run_is_checked_too() {
    let text = expecting("metric = \"static_error_rad\"\nunit = \"rad\"\nmax = 1");
    read(&text, &[]).expect("a run of 2 s");
    let message = read(&text, &set(["run.duration_s=0.5"])).expect_err("a run of 0.5 s");
    insta::assert_snapshot!(message, @r#"
    x.toml:12: expect.0.metric: "static_error_rad" needs a longer run than 0.5 s; its definition: Mean of e over the last second.
    "#);
}

#[test]
fn signals_are_checked_once_plant_and_drive_are_known() {
    let check = |keys: &str, signals: &SignalTable| {
        let scenario: Scenario = read(&expecting(keys), &[]).expect(keys);
        scenario.check_expectations(signals).map_err(|errors| errors.to_string())
    };
    let known = "signal = \"twist_rad\"\nstatistic = \"rms\"\nunit = \"rad\"\nmax = 1";
    check(known, &signals()).expect("a signal of the plant");
    let no_gap = SignalTable { plant: vec![Signal::new("twist_rad", "rad")], ..signals() };
    let no_estimate = SignalTable { drive: Vec::new(), ..signals() };
    let estimate = "metric = \"dead_zone_error_rad\"\nunit = \"rad\"\nmax = 1";
    check(estimate, &signals()).expect("an estimate");
    let cases = [
        ("signal = \"twst_rad\"\nstatistic = \"rms\"\nunit = \"rad\"\nmax = 1", signals()),
        ("signal = \"dead_zone_estimate_rad\"\nstatistic = \"rms\"\nunit = \"rad\"\nmax = 1", signals()),
        ("signal = \"twist_rad\"\nstatistic = \"rms\"\nunit = \"mrad\"\nmax = 1", signals()),
        ("signal = \"drive.requested_torque_nm\"\nstatistic = \"rms\"\nunit = \"Nm\"\nmax = 1", signals()),
        (estimate, no_gap),
        (estimate, no_estimate),
    ];
    let messages: Vec<_> =
        cases.iter().map(|(keys, signals)| check(keys, signals).expect_err(keys)).collect();
    insta::assert_snapshot!(messages.join("\n"), @r#"
    x.toml:12: expect.0.signal: "twst_rad" is not measured: the run has no signal of this name (did you mean twist_rad?); it has reference_rad, load_position_rad, motor_position_rad, torque_nm, twist_rad, dead_zone_rad, drive.requested_torque_nm, drive.dead_zone_estimate_rad
    x.toml:12: expect.0.signal: "dead_zone_estimate_rad" is a signal of the drive; write "drive.dead_zone_estimate_rad"
    x.toml:14: expect.0.unit: "mrad" is not the unit of twist_rad; it must be "rad"
    x.toml:14: expect.0.unit: "Nm" is not the unit of drive.requested_torque_nm; it must be "N m"
    x.toml:12: expect.0.metric: "dead_zone_error_rad" needs the signal dead_zone_rad of the plant, which the model smooth does not have; take another metric
    x.toml:12: expect.0.metric: "dead_zone_error_rad" needs the signal dead_zone_estimate_rad of the drive, which the telemetry of the law pd does not carry; add it to telemetry.signals, or take a law that has it
    "#);
}
