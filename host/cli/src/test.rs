//! `lashloop test`: every scenario of files and folders, their sweeps included.

mod dry_run;
mod reports;

use std::fs;
use std::io::{self, IsTerminal};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::resume::ResumeError;
use lashloop_bench::scenario::Override;
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::Exit;

use super::campaign_run::jobs;
use super::clock_options::ClockOptions;
use super::error::{CliError, system};
use super::options::{drive_help, plants};
use super::output::{error_line, outln, prepare_folder, print_json};
use super::progress::Progress;
use super::supervision::start_supervisor;
use lashloop::Bench;
use lashloop_campaign::CampaignError;
use lashloop_campaign::facts::program_sha256;
use lashloop_campaign::suite::baseline::{Baseline, path_of};
use lashloop_campaign::suite::case_result::Status;
use lashloop_campaign::suite::files::find;
use lashloop_campaign::suite::journal::{Header, Journal};
use lashloop_campaign::suite::plan::{self, Common};
use lashloop_campaign::suite::runner::Runner;
use lashloop_campaign::suite::table::{Table, line, name_width};
use lashloop_campaign::suite::tally::{Conclusion, Tally};
use lashloop_campaign::workers::{self, Order};
use lashloop_session::counted;
use reports::TestReports;

/// Run every scenario of files and folders, sweeps included, and print one table
///
/// A scenario with `[sweep]` is many cases. A metric is compared with its baseline, if the scenario has one: NAME.baseline.toml
/// next to NAME.toml. Exit code: the largest of any case, 2 if no case could be run. Skipped cases do not affect
/// the exit code.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenarios in TOML, or folders of them
    #[arg(required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,

    #[arg(long, default_value = "native", value_name = "DEVICE", help = drive_help())]
    device: DeviceChoice,

    /// Runs in parallel [default: number of cores; 1 in real time and on a drive that the bench does not start]
    #[arg(long)]
    jobs: Option<NonZeroUsize>,

    /// Value instead of that of every scenario, such as link.answer_timeout_ms=10000; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,

    #[command(flatten)]
    clock: ClockOptions,

    /// Folder for results: cases.jsonl grows with each case, records/ has the record of each case that did not pass
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Keep the records of cases that pass too
    #[arg(long, requires = "out")]
    keep_passes: bool,

    /// Complete the suite in --out; a case with a verdict is not run again unless its scenario has changed
    #[arg(long, requires = "out", conflicts_with = "force")]
    resume: bool,

    /// Replace the results in --out
    #[arg(long, requires = "out")]
    force: bool,

    /// File for the results as JUnit XML
    #[arg(long, value_name = "FILE.xml")]
    junit: Option<PathBuf>,

    /// File for the results as a page for a browser; with --out each record has a report.html
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,

    /// Report a case with neither an expectation nor a baseline as an error: its PASS says nothing of the drive
    #[arg(long, conflicts_with = "update")]
    require_expectations: bool,

    /// Write the metrics of each case that passes to its baseline, instead of comparing them
    #[arg(long, conflicts_with = "set")]
    update: bool,

    /// Check scenarios, the cases of their sweeps and their baselines without a run
    ///
    /// Prints each error as `path:line:column: message`. What only a drive knows is checked by a run: the names of its laws,
    /// parameters and signals. Exit code 2 if there is an error.
    #[arg(long, conflicts_with_all = ["out", "junit", "html", "update"])]
    dry_run: bool,

    /// Print the results of the cases as a JSON array; with --dry-run, the errors with file, line, column and message
    #[arg(long, conflicts_with = "update")]
    json: bool,
}

const JOURNAL: &str = "cases.jsonl";
const RECORDS: &str = "records";

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        if self.dry_run {
            let overrides: Vec<_> = self.set.into_iter().map(Override::Set).collect();
            return dry_run::check_all(
                &find(&self.paths)?,
                &overrides,
                &plants(bench),
                (self.require_expectations, self.json),
            );
        }
        let reports = TestReports { junit: self.junit.as_deref(), html: self.html.as_deref() };
        let files = find(&self.paths);
        reports.check(files.as_deref().unwrap_or(&self.paths))?;
        let ended = files.map_err(CliError::from).and_then(|files| self.run_suite(&files, &reports, bench));
        ended.inspect_err(|error| match error {
            // The results of the earlier suite stay, and with them its reports.
            CliError::Leftovers { .. } | CliError::Campaign(CampaignError::Resume(_)) => {}
            error => reports.fail(error),
        })
    }

    fn run_suite(
        &self,
        files: &[PathBuf],
        reports: &TestReports<'_>,
        bench: &Bench,
    ) -> Result<Exit, CliError> {
        let started = Instant::now();
        let clock = self.clock.clock()?;
        let jobs = jobs(self.jobs, &self.device, clock.name())?;
        let overrides: Vec<_> = self.set.iter().cloned().map(Override::Set).collect();
        let plants = plants(bench);
        let common = Common {
            device: &self.device,
            clock: clock.name(),
            overrides: &overrides,
            plants: &plants,
            compares: !self.update,
            requires_expectations: self.require_expectations,
        };
        let cases = plan::cases(files, &common);
        let mut tally = Tally::new(&cases);
        let mut journal = match &self.out {
            Some(folder) => Some(self.open_journal(folder, clock.name(), &mut tally)?),
            None => None,
        };
        reports.begin(&tally)?;
        let supervisor = start_supervisor()?;
        let records = self.out.as_ref().map(|folder| folder.join(RECORDS));
        let runner = Runner {
            device: &self.device,
            clock,
            records: records.as_deref(),
            keeps_passes: self.keep_passes,
            overrides: &overrides,
            plants: &plants,
        };
        let (missing, total) = (tally.missing(), cases.len());
        let progress = Progress::over(counted(total as u64, "case"), total as u64);
        progress.show(tally.done() as u64);
        let (is_terminal, width) = (io::stderr().is_terminal(), name_width(&tally));
        let signals = supervisor.guard_signals();
        let ended = workers::run_all(
            missing.len() as u64,
            jobs,
            Order::Arrival,
            &supervisor,
            |case, stop| Ok(runner.run(missing[case as usize], stop)?),
            |result| {
                if let Some(journal) = &mut journal {
                    journal.append(&result)?;
                }
                let number = tally.done() + 1;
                if let Some(result) = tally.add(result).filter(|_| !is_terminal) {
                    error_line(format_args!("{number:>4}/{total} {}", line(result, width)));
                }
                progress.show(number as u64);
                Ok::<_, CliError>(())
            },
        );
        drop(signals);
        drop(progress);
        let wall_s = started.elapsed().as_secs_f64();
        if self.json {
            print_json(&tally.rows().map(|(_, result)| result).collect::<Vec<_>>())?;
        } else {
            outln!("{}", Table { tally: &tally, wall_s });
        }
        ended?;
        reports.finish(&tally, wall_s)?;
        match tally.conclusion() {
            Conclusion::Incomplete if !self.json => {
                let hint = if self.out.is_some() { "--resume completes it" } else { "--out keeps results" };
                outln!("interrupted; {hint}");
            }
            Conclusion::Judged(_) | Conclusion::NothingRun if self.update => update_baselines(&tally)?,
            _ => {}
        }
        Ok(tally.conclusion().exit())
    }

    /// Opens the journal, with its lock: only then may results of an earlier suite be removed.
    fn open_journal(
        &self,
        folder: &Path,
        clock: ClockName,
        tally: &mut Tally<'_>,
    ) -> Result<Journal, CliError> {
        let path = folder.join(JOURNAL);
        prepare_folder(folder, &[])?;
        let header = Header {
            lashloop: env!("CARGO_PKG_VERSION").to_owned(),
            program_sha256: program_sha256().map_err(system("read this program"))?,
            device: self.device.to_string(),
            clock: clock.to_string(),
        };
        if self.resume {
            return Ok(Journal::resume(&path, &header, |result| tally.restore(result))?);
        }
        if self.force {
            let journal = Journal::replace(&path, &header)?;
            return match fs::remove_dir_all(folder.join(RECORDS)) {
                Err(source) if source.kind() != io::ErrorKind::NotFound => {
                    Err(CliError::Output { path: folder.to_owned(), source })
                }
                _ => Ok(journal),
            };
        }
        Journal::create(&path, &header).map_err(|error| match error {
            CampaignError::Resume(ResumeError::Exists { .. }) => {
                CliError::Leftovers { folder: folder.to_owned() }
            }
            other => other.into(),
        })
    }
}

/// Writes the metrics of each case that has passed to the baseline of its file.
fn update_baselines(tally: &Tally<'_>) -> Result<(), CliError> {
    let rows: Vec<_> = tally.rows().collect();
    for group in rows.chunk_by(|(one, _), (next, _)| one.file == next.file) {
        let path = path_of(&group[0].0.file);
        let passed = group.iter().filter(|(_, result)| result.status == Status::Pass);
        let mut baseline = Baseline::read(&path)?.unwrap_or_default();
        let mut count = 0;
        for (case, result) in passed {
            for metric in baseline.update(&case.settings, &result.metrics) {
                outln!("{}: {metric} has no value; its entry stays", case.name);
            }
            count += 1;
        }
        if count > 0 {
            baseline.retain(|settings| group.iter().any(|(case, _)| case.settings == settings));
            baseline.write(&path)?;
            outln!("updated {}: {count} of {}", path.display(), counted(group.len() as u64, "case"));
        }
    }
    Ok(())
}
