//! The library as a user's test calls it.

mod line;
mod loop_in_c;
mod replayed;
mod untimed;

use std::thread;

use lashloop::{Bench, Error, NoMetric, Outcome, Verdict, run};
use own_law::OwnLaws;

const OWN_LAW: &str = "../examples/own-law/own-law.toml";
const PAPER: &str = "../scenarios/smooth-after.toml";

fn in_process(bench: &Bench, path: &str, settings: &[&str]) -> Result<Outcome, Error> {
    run(&bench.scenario(path, settings)?, &bench.device("inproc")?)
}

#[test]
fn a_run_has_the_pinned_torques_of_the_program() {
    let outcome = in_process(&Bench::new(), PAPER, &[]).expect("a run");
    let pinned = "cf2cc37c6f429c01271328c5448cb2991944dcdf4ccfed17aefec878f094602d";
    assert_eq!((outcome.torque_sha256(), outcome.verdict()), (pinned, Verdict::Pass));
    let settle_s = outcome.metric("settle_time_s").expect("the load settles");
    let time_s = outcome.signal("time_s").expect("a column");
    let load_rad = outcome.signal("load_position_rad").expect("a column");
    let last_outside = load_rad.iter().rposition(|rad| rad.abs() > 0.05).expect("it starts outside");
    assert!((time_s[last_outside] - settle_s).abs() < 2e-3, "{} s, {settle_s} s", time_s[last_outside]);
}

#[test]
fn a_missed_expectation_is_a_verdict_and_is_named() {
    let outcome = in_process(&Bench::new(), PAPER, &["controller.name=pd"]).expect("a run");
    assert_eq!(outcome.verdict(), Verdict::Fail);
    let text = outcome.to_string();
    assert!(text.starts_with("FAIL\nsettle_time_s: 12.") && text.contains("misses"), "{text}");
}

#[test]
fn a_missing_name_is_an_error_with_the_nearest_one() {
    let outcome = in_process(&Bench::new(), PAPER, &["run.duration_s=0.1", "expect=[]"]).expect("a run");
    let signal = outcome.signal("load_position").expect_err("the unit is missing").to_string();
    assert!(signal.contains("did you mean load_position_rad?"), "{signal}");
    let metric = outcome.metric("settle_tme_s").expect_err("a misspelling").to_string();
    assert!(metric.contains("did you mean settle_time_s?"), "{metric}");
    let never = outcome.metric("settle_time_s").expect_err("0.1 s are too short");
    assert_eq!(never, NoMetric::NoValue { name: "settle_time_s", reason: "never".to_owned() });
}

#[test]
fn benches_in_two_threads_keep_their_own_laws() {
    let own = Bench::new().with_laws::<OwnLaws>();
    let short = ["run.duration_s=0.5", "expect=[]"];
    let law = |bench: &Bench| in_process(bench, OWN_LAW, &short).map(|outcome| outcome.signals().len());
    thread::scope(|scope| {
        let with = scope.spawn(|| law(&own).expect("the law is there"));
        let without = scope.spawn(|| law(&Bench::new()).expect_err("the law is not there").to_string());
        assert!(with.join().expect("a thread") > 20);
        let without = without.join().expect("a thread");
        assert!(without.contains("velocity-pi") && without.contains("no law of this name"), "{without}");
    });
}

#[test]
fn a_device_that_a_test_lacks_is_refused_with_a_remedy() {
    let bench = Bench::new();
    let scenario = bench.scenario(PAPER, &[]).expect("a scenario");
    let native = bench.device("native").expect("a device");
    let error = run(&scenario, &native).expect_err("a test isn't a twin").to_string();
    assert!(error.starts_with("native: ") && error.contains("use inproc"), "{error}");
    let error = bench.device("banana").expect_err("no device").to_string();
    assert!(error.starts_with("\"banana\" isn't a device: expected inproc, native"), "{error}");
}

#[test]
fn a_wrong_setting_is_an_error_at_its_place() {
    let error = Bench::new().scenario(PAPER, &["plant.stifness_nm_rad=2"]).expect_err("a misspelling");
    let text = error.to_string();
    assert!(text.contains("plant.stifness_nm_rad=2") && text.contains("stiffness_nm_rad"), "{text}");
}
