//! `lashloop test --dry-run`: scenarios without a run, for editors and hooks.

use std::path::{Path, PathBuf};

use lashloop_bench::scenario::cases::Cases;
use lashloop_bench::scenario::{Override, ScenarioError};
use lashloop_bench::verdict::Exit;
use lashloop_plant::Plants;
use serde::Serialize;

use crate::error::CliError;
use crate::output::{outln, print_json};
use lashloop_campaign::suite::baseline::{Baseline, path_of};

/// An error at its place; line and column from 1.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
struct Finding {
    file: String,
    line: usize,
    column: usize,
    message: String,
}

/// Prints each error of these scenarios, the cases of their sweeps and their baselines as `path:line:column: message`.
pub(super) fn check_all(
    files: &[PathBuf],
    overrides: &[Override],
    plants: &Plants,
    (requires_expectations, as_json): (bool, bool),
) -> Result<Exit, CliError> {
    let mut findings: Vec<_> =
        files.iter().flat_map(|file| check(file, overrides, plants, requires_expectations)).collect();
    findings.sort();
    // Many cases of a sweep have one error.
    findings.dedup();
    if as_json {
        print_json(&findings)?;
    } else {
        for Finding { file, line, column, message } in &findings {
            outln!("{file}:{line}:{column}: {message}");
        }
    }
    Ok(if findings.is_empty() { Exit::Pass } else { Exit::UsageOrScenario })
}

fn check(file: &Path, overrides: &[Override], plants: &Plants, requires_expectations: bool) -> Vec<Finding> {
    let finding = |error: &ScenarioError| {
        let (file, line, column) = error.place().unwrap_or_else(|| (file.display().to_string(), 1, 1));
        Finding { file, line, column, message: error.problem() }
    };
    let mut expects_nothing = false;
    let mut findings = match Cases::from_file(file, overrides, plants) {
        Err(errors) => errors.iter().map(finding).collect(),
        Ok(cases) => {
            let mut findings = Vec::new();
            for case in cases.settings() {
                match cases.scenario(case) {
                    Err(errors) => findings.extend(errors.iter().map(finding)),
                    Ok(scenario) => expects_nothing |= scenario.expectations.is_empty(),
                }
            }
            findings
        }
    };
    match Baseline::read(&path_of(file)) {
        Err(error) => {
            let (file, line, message) = error.place();
            findings.push(Finding { file, line, column: 1, message });
        }
        Ok(None) if requires_expectations && expects_nothing => findings.push(Finding {
            file: file.display().to_string(),
            line: 1,
            column: 1,
            message: "nothing is expected of it; give it an [[expect]], or a baseline by --update".to_owned(),
        }),
        Ok(_) => {}
    }
    findings
}
