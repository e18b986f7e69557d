//! Baselines: written, compared, kept.

use super::fixture::{SHORT, Suite};

#[test]
fn a_metric_that_leaves_its_baseline_fails_and_is_named() {
    let suite = Suite::new(&[("a.toml", SHORT.to_owned())]);
    let _ = suite.run(&["--update"]).with_code(0);
    let _ = suite.run(&[]).with_code(0);
    let baseline = suite.read("s/a.baseline.toml");
    let line = baseline.lines().find(|line| line.starts_with("peak_tracking_error_rad")).expect("a metric");
    assert_eq!(line, "peak_tracking_error_rad = { value = 1.5708, tolerance = 0.031 }");
    suite.write("a.baseline.toml", &baseline.replace(line, &line.replace("1.5708", "1.5")));
    let ended = suite.run(&[]).with_code(1);
    let sentence = "peak_tracking_error_rad: 1.5708 rad; leaves its baseline 1.5 +- 0.031 rad";
    assert!(ended.stdout.contains(sentence), "{}", ended.stdout);
    // An update takes the new value and keeps the tolerance.
    let _ = suite.run(&["--update"]).with_code(0);
    assert_eq!(suite.read("s/a.baseline.toml"), baseline);
}

#[test]
fn a_restored_case_is_compared_with_the_baseline_of_today() {
    let suite = Suite::new(&[("a.toml", SHORT.to_owned())]);
    let out = suite.path("out");
    let peak = |value: &str| {
        let metric = format!("peak_tracking_error_rad = {{ value = {value}, tolerance = 0.03 }}");
        suite.write("a.baseline.toml", &format!("[[case]]\n[case.metrics]\n{metric}\n"));
    };
    let _ = suite.run(&["--out", &out]).with_code(0);
    peak("1.4");
    let resumed = suite.run(&["--out", &out, "--resume"]).with_code(1);
    assert!(resumed.stdout.contains("leaves its baseline 1.4 +- 0.03 rad"), "{}", resumed.stdout);
    peak("1.5708");
    let resumed = suite.run(&["--out", &out, "--resume"]).with_code(0);
    assert!(resumed.stdout.contains("1 of 1 met"), "{}", resumed.stdout);
    peak("1.4");
    let _ = suite.run(&["--out", &out, "--force"]).with_code(1);
    let updated = suite.run(&["--out", &out, "--resume", "--update"]).with_code(0);
    assert!(updated.stdout.contains("a.baseline.toml: 1 of 1 case"), "{}", updated.stdout);
    let resumed = suite.run(&["--out", &out, "--resume"]).with_code(0);
    assert_eq!(resumed.stderr, "", "the case has run once and once by force");
}

#[test]
fn an_update_keeps_a_metric_without_value_and_reports_it() {
    let suite = Suite::new(&[("a.toml", SHORT.to_owned())]);
    let baseline = "[[case]]\n[case.metrics]\nsettle_time_s = { value = 5.0, tolerance = 1.0 }\n";
    suite.write("a.baseline.toml", baseline);
    let ended = suite.run(&["--update"]).with_code(0);
    let sentence = "a.toml: settle_time_s has no value; its entry stays";
    assert!(ended.stdout.contains(sentence), "{}", ended.stdout);
    assert!(suite.read("s/a.baseline.toml").ends_with(baseline), "{}", suite.read("s/a.baseline.toml"));
    let _ = suite.run(&[]).with_code(1);
}

#[test]
fn an_update_takes_no_setting_of_the_command_line() {
    let suite = Suite::new(&[("a.toml", SHORT.to_owned())]);
    let ended = suite.run(&["--update", "--set", "run.duration_s=2"]).with_code(2);
    assert!(ended.stderr.contains("'--update' cannot be used with '--set"), "{}", ended.stderr);
}
