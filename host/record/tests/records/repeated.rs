//! The scenario in a record runs again as it is, to the same bits.

use std::fs;

use lashloop_bench::scenario::{Override, Scenario};
use lashloop_record::resolved;

use super::{all_scenarios, run_in_process};

/// The resolved scenario in a folder of its own, read without an override.
fn read_back(scenario: &Scenario) -> Scenario {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in resolved::files(scenario).expect("files") {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    Scenario::from_file(&folder.path().join("scenario.toml"), &[]).expect("the resolved scenario")
}

#[test]
fn every_scenario_of_the_tree_repeats_from_its_record() {
    let mut with_table = 0;
    for path in all_scenarios() {
        // Half a second tells runs apart; the gap of another width has to reach the resolved scenario.
        let settings = ["run.duration_s=0.5", "run.mode=hil", "run.seed=7", "expect=[]"];
        let overrides: Vec<_> = settings.map(|it| Override::Set(it.to_owned())).into();
        let scenario = Scenario::from_file(&path, &overrides).unwrap_or_else(|error| panic!("{error}"));
        let again = read_back(&scenario);
        with_table += usize::from(resolved::files(&scenario).expect("files").len() == 2);
        let [first, second] = [&scenario, &again].map(|it| run_in_process(it, Vec::new()));
        let digest = |run: Result<lashloop_bench::run::Outcome, _>| match run {
            Ok(outcome) => outcome.torque_sha256,
            Err(error) => format!("{error:?}"),
        };
        assert_eq!(digest(first), digest(second), "{}", path.display());
    }
    assert_eq!(with_table, 1, "scenarios with a reference by table");
}
