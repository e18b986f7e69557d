//! `lashloop check`: scenarios without a run, for editors and hooks.

use std::path::{Path, PathBuf};

use clap::Args;
use lashloop_bench::scenario::ScenarioError;
use lashloop_bench::scenario::cases::Cases;
use lashloop_bench::verdict::Exit;
use lashloop_plant::Plants;
use serde::Serialize;

use super::error::{CliError, system};
use super::options::plants;
use super::output::outln;
use lashloop::Bench;
use lashloop_campaign::suite::baseline::{Baseline, path_of};
use lashloop_campaign::suite::files::find;

/// Check scenarios, the cases of their sweeps and their baselines, without a drive
///
/// Prints each error as `path:line:column: message`. What only a drive knows is checked by a run: the names of its laws,
/// parameters and signals. Exit code 2 if there is an error.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenarios in TOML, or folders of them
    #[arg(required = true, value_name = "SCENARIO")]
    paths: Vec<PathBuf>,

    /// Print an array of objects with file, line, column and message
    #[arg(long)]
    json: bool,
}

/// An error at its place; line and column from 1.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
struct Finding {
    file: String,
    line: usize,
    column: usize,
    message: String,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let plants = plants(bench);
        let files = find(&self.paths)?;
        let mut findings: Vec<_> = files.iter().flat_map(|file| check(file, &plants)).collect();
        findings.sort();
        // Many cases of a sweep have one error.
        findings.dedup();
        if self.json {
            outln!("{}", serde_json::to_string_pretty(&findings).map_err(system("print JSON"))?);
        } else {
            for Finding { file, line, column, message } in &findings {
                outln!("{file}:{line}:{column}: {message}");
            }
        }
        Ok(if findings.is_empty() { Exit::Pass } else { Exit::UsageOrScenario })
    }
}

fn check(file: &Path, plants: &Plants) -> Vec<Finding> {
    let finding = |error: &ScenarioError| {
        let (file, line, column) = error.place().unwrap_or_else(|| (file.display().to_string(), 1, 1));
        Finding { file, line, column, message: error.problem() }
    };
    let mut findings = match Cases::from_file(file, &[], plants) {
        Err(errors) => errors.iter().map(finding).collect(),
        Ok(cases) => {
            let errors = cases.settings().iter().filter_map(|case| cases.scenario(case).err());
            errors.flat_map(|errors| errors.iter().map(finding).collect::<Vec<_>>()).collect::<Vec<_>>()
        }
    };
    if let Err(error) = Baseline::read(&path_of(file)) {
        let (file, line, message) = error.place();
        findings.push(Finding { file, line, column: 1, message });
    }
    findings
}
