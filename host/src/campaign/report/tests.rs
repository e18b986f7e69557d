use super::*;
use crate::campaign::case::CaseId;

fn result(part: Part, row: u32, law: Law, settle_time: &str, end: &str) -> CaseResult {
    let other = if settle_time.starts_with('"') { settle_time } else { "-0.001" };
    let hunting = if settle_time.starts_with('"') { settle_time } else { "0.0" };
    let deviation = if law == Law::BRAKING_CURVE { other } else { "\"none\"" };
    let scores = format!(
        r#"{{"settle_time_s":{settle_time},"overshoot_rad":{other},"static_error_rad":{other},
        "static_error_bands":{other},"hunting_rad":{hunting},"dead_zone_error_rad":{other},
        "learnt_dead_zone_error_rad":{other},"dead_zone_deviation_rad":{deviation},"effort_nm2s":{other},
        "torque_total_variation_nm":{other}}}"#
    );
    CaseResult {
        case: CaseId { part, row, law },
        end: end.to_owned(),
        scores: serde_json::from_str(&scores).expect("scores"),
        torque_sha256: String::new(),
    }
}

/// A report on twenty plants, `diverged` of which diverge.
fn report(diverged: u32) -> Report {
    let laws = vec![Law::BEFORE, Law::BACKLASH_INVERSE, Law::BRAKING_CURVE];
    let settings = Settings { seed: 1, plants: 20, laws, sweeps: true };
    let mut results = Vec::new();
    for row in 0..20 {
        results.push(result(Part::RandomPlants, row, Law::BEFORE, "\"never\"", "complete"));
        let (time, end) = if row < diverged { ("\"not finite\"", "it blew up") } else { ("2.5", "complete") };
        results.push(result(Part::RandomPlants, row, Law::BACKLASH_INVERSE, time, end));
        results.push(result(Part::RandomPlants, row, Law::BRAKING_CURVE, "1.25", "complete"));
    }
    results.push(result(Part::TorqueDelay, 5, Law::BEFORE, "\"cut short\"", "the drive latched it"));
    Report::new(&settings, results.iter())
}

#[test]
fn one_diverged_run_fails_the_battery_and_is_in_the_tables() {
    assert_eq!(report(0).verdict, Verdict::Pass);
    let report = report(1);
    assert_eq!(report.verdict, Verdict::Fail);
    let met: Vec<_> = report.limits.iter().map(|result| result.met).collect();
    assert_eq!(met[..4], [true, false, false, true], "the 19th of 20 is the 95 % quantile");
    assert_eq!(met[4..], [true; 8], "another law's run is no run of this one");
    insta::assert_snapshot!(report);
}

#[test]
fn without_a_limited_law_the_report_states_no_limits() {
    let settings = Settings { seed: 1, plants: 1, laws: vec![Law::BEFORE], sweeps: false };
    let results = [result(Part::RandomPlants, 0, Law::BEFORE, "\"never\"", "complete")];
    let report = Report::new(&settings, results.iter());
    assert!(report.limits.is_empty());
    assert!(report.to_string().ends_with("no limits: none of these laws has any"), "{report}");
}
