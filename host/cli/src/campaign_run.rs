//! From a campaign to its verdict: a shard or all of it, merged, reported, and its evidence kept.

use std::io::Write as _;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Instant;

use clap::Args;
use lashloop_bench::atomic_file::write_whole;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::resume;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::Exit;
use lashloop_campaign::Campaign;
use lashloop_campaign::engine::{Progress as Done, ShardRun};
use lashloop_campaign::evidence::{self, Pick, Repeater};
use lashloop_campaign::facts::{Facts, Program, program_sha256};
use lashloop_campaign::merge::{self, MergeLock, RESULTS};
use lashloop_campaign::report::Report;
use lashloop_campaign::run::run_case;
use lashloop_campaign::shard::Shard;
use lashloop_campaign::shard_file::Start;
use lashloop_campaign::table::Table;
use lashloop_campaign::view::View;
use lashloop_campaign::workers::Ended;
use lashloop_record::file_names::REPORT_FILE;
use lashloop_record::json_file::write_json;

use super::campaign_report;
use super::error::{CliError, system};
use super::output::{complain, error_line, outln, prepare_folder, write_file};
use super::progress::Progress;
use super::supervision::start_supervisor;

pub(super) const REPORT_JSON: &str = "report.json";
pub(super) const REPORT_TEXT: &str = "report.txt";

/// How many runs at a time, and where their results go.
#[derive(Args)]
pub(super) struct RunsOptions {
    /// Runs in parallel [default: number of cores]
    #[arg(long)]
    pub(super) jobs: Option<NonZeroUsize>,

    /// Folder for the results: shards, results.csv, reports, and for `campaign` the evidence
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,

    /// Continue the results in the folder of --out
    #[arg(long, requires = "out")]
    pub(super) resume: bool,
}

/// A campaign on a device, into a folder.
pub(super) struct Execution<'a> {
    pub(super) campaign: &'a Campaign,
    pub(super) device: &'a DeviceChoice,
    pub(super) folder: &'a Path,
    pub(super) supervisor: &'a Supervisor,
    /// Whether the folder outlives the command, so that records of runs are worth their time.
    pub(super) is_kept: bool,
}

impl RunsOptions {
    /// Runs a shard into the folder of --out, or a temporary one. `then` follows unless the user stops it.
    pub(super) fn run(
        &self,
        campaign: &Campaign,
        device: &DeviceChoice,
        jobs: NonZeroUsize,
        shard: Shard,
        shows_speed: bool,
        then: impl FnOnce(&Execution<'_>) -> Result<Exit, CliError>,
    ) -> Result<Exit, CliError> {
        let temporary;
        let folder = match &self.out {
            Some(out) => out.as_path(),
            None => {
                temporary = tempfile::tempdir().map_err(system("create a temporary folder"))?;
                temporary.path()
            }
        };
        let (supervisor, is_kept) = (&start_supervisor()?, self.out.is_some());
        let execution = Execution { campaign, device, folder, supervisor, is_kept };
        let start = if self.resume { Start::Resume } else { Start::New };
        let done = execution.run(shard, jobs, start, shows_speed)?;
        if let Some(text) = interruption(done, shard.len(campaign.plan.cases()), self.out.as_deref()) {
            outln!("{text}");
            return Ok(Exit::Invalid);
        }
        then(&execution)
    }
}

/// A merged campaign with its report.
pub(super) struct Concluded {
    pub(super) report: Report,
    /// Runs that are not PASS and have no record.
    pub(super) failures_without_record: Option<String>,
}

impl Execution<'_> {
    /// Runs a shard.
    fn run(
        &self,
        shard: Shard,
        jobs: NonZeroUsize,
        start: Start,
        shows_speed: bool,
    ) -> Result<Done, CliError> {
        prepare_folder(self.folder, &[])?;
        if !resume::has_locks(self.folder).map_err(system("create a file in the folder of the results"))? {
            complain(format_args!(
                "the file system of {} has no locks (flock), so a shard that is started twice is damaged; start each once",
                self.folder.display()
            ));
        }
        let facts = Facts::new(self.campaign, self.program()?, shard.count);
        let all = shard.len(self.campaign.plan.cases());
        let progress = Progress::over(format!("{all} runs"), all);
        let run =
            ShardRun { campaign: self.campaign, facts: &facts, folder: self.folder, shard, start, jobs };
        let started = Instant::now();
        let signals = self.supervisor.guard_signals();
        let done = run.run(
            self.supervisor,
            |case, stop| run_case(self.campaign, self.device, case, stop),
            |rows| progress.show(rows),
        );
        drop(signals);
        drop(progress);
        let done = done?;
        if done.restored > 0 {
            error_line(format_args!("{} of {all} runs restored", done.restored));
        }
        let (runs, wall_s) = (done.rows - done.restored, started.elapsed().as_secs_f64());
        if shows_speed && runs > 0 {
            let jobs = (jobs.get() as u64).min(runs);
            let cores = thread::available_parallelism().map_or(jobs, |cores| jobs.min(cores.get() as u64));
            let rate = runs as f64 / wall_s / cores as f64;
            error_line(format_args!(
                "{runs} runs in {wall_s:.1} s, {jobs} at a time: {rate:.2} runs per second and core"
            ));
        }
        Ok(done)
    }

    /// As [`conclude_locked`](Self::conclude_locked), from the lock on.
    pub(super) fn conclude(&self) -> Result<Option<Concluded>, CliError> {
        self.conclude_locked(&begin_merge(self.folder)?)
    }

    /// Merges the shards, keeps the evidence, and writes the reports; `None` if the user stopped it. `report.json` is last: it
    /// marks a folder as merged.
    pub(super) fn conclude_locked(&self, _lock: &MergeLock) -> Result<Option<Concluded>, CliError> {
        let facts = merge::merge(self.folder)?;
        let path = self.folder.join(RESULTS);
        let table = Table::new(self.campaign, &path);
        let view = View::new(&table)?;
        let report = &view.report;
        #[cfg(feature = "parquet")]
        lashloop_campaign::parquet::write(
            &table,
            &facts,
            &self.folder.join(lashloop_campaign::parquet::RESULTS),
        )?;
        let picks = if self.is_kept { evidence::picks(&table)? } else { Vec::new() };
        let signals = self.supervisor.guard_signals();
        let progress = Progress::over(format!("{} records", picks.len()), picks.len() as u64);
        for (count, pick) in (1..).zip(&picks) {
            if self.repeater().keep(pick, self.folder)?.is_none() {
                return Ok(None);
            }
            progress.show(count);
        }
        drop(progress);
        drop(signals);
        let failures_without_record = self.failures_without_record(report, &picks);
        let page = campaign_report::page(self.folder, self.campaign, &facts, &view, &picks)?;
        write_file(&self.folder.join(REPORT_FILE), &page)?;
        write_whole(&self.folder.join(REPORT_TEXT), ".report-", |file| {
            writeln!(file, "{report}")?;
            failures_without_record.iter().try_for_each(|text| writeln!(file, "{text}"))
        })?;
        write_json(&self.folder.join(REPORT_JSON), ".report-", report)?;
        Ok(Some(Concluded { report: view.report, failures_without_record }))
    }

    fn failures_without_record(&self, report: &Report, picks: &[Pick]) -> Option<String> {
        let failures: u64 = report.groups.iter().map(|group| group.fail + group.invalid).sum();
        let failures = failures - report.no_run.cases;
        let recorded = picks.iter().filter(|pick| pick.is_failure()).count() as u64;
        let without = failures - recorded.min(failures);
        (without > 0 && self.is_kept).then(|| {
            format!(
                "{without} of {failures} failures have no record; `lashloop campaign rerun DIR --case I --out FOLDER` makes one, \
                 evidence.failures of the campaign file more"
            )
        })
    }

    pub(super) fn repeater(&self) -> Repeater<'_> {
        let Self { campaign, device, supervisor, .. } = self;
        Repeater { campaign, device, supervisor }
    }

    /// What the rows come from, by a session with the drive.
    fn program(&self) -> Result<Program, CliError> {
        let first = self.campaign.scenario(&self.campaign.case(0)?)?;
        let opened = lashloop::Execution::new(first, self.device.into()).open(self.supervisor)?;
        let files = opened.device().evidence().files;
        let hashes: Vec<_> = files.into_iter().map(|file| file.sha256.unwrap_or(file.path)).collect();
        Ok(Program {
            lashloop: env!("CARGO_PKG_VERSION").to_owned(),
            sha256: program_sha256().map_err(system("read this program"))?,
            device: self.device.to_string(),
            drive: if hashes.is_empty() { opened.device().description() } else { hashes.join(",") },
        })
    }
}

/// Locks a folder for a merge, and removes the reports of an earlier one: a merge that fails leaves none.
pub(super) fn begin_merge(folder: &Path) -> Result<MergeLock, CliError> {
    let lock = MergeLock::take(folder)?;
    prepare_folder(folder, &[REPORT_JSON, REPORT_TEXT, REPORT_FILE])?;
    Ok(lock)
}

/// Runs at once: as many as cores, and one on a drive that has one session or in real time.
pub(super) fn jobs(
    wanted: Option<NonZeroUsize>,
    device: &DeviceChoice,
    clock: ClockName,
) -> Result<NonZeroUsize, CliError> {
    let what = if !device.has_drive_per_session() {
        format!("--device {device}")
    } else if clock == ClockName::RealTime {
        "a machine that keeps real time".to_owned()
    } else {
        return Ok(wanted.or_else(|| thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN));
    };
    match wanted {
        Some(jobs) if jobs > NonZeroUsize::MIN => Err(CliError::Jobs { jobs, what }),
        _ => Ok(NonZeroUsize::MIN),
    }
}

/// What an interrupted command left.
fn interruption(done: Done, all: u64, kept_in: Option<&Path>) -> Option<String> {
    let kept = match (done.ended, kept_in) {
        (Ended::Complete, _) => return None,
        (Ended::Interrupted, Some(folder)) => format!("kept in {}; resume with --resume", folder.display()),
        (Ended::Interrupted, None) => "lost; --out keeps them".to_owned(),
    };
    Some(format!("interrupted: {} of {all} runs are complete and {kept}", done.rows))
}

/// What an interrupted merge left.
pub(super) fn evidence_interrupted(folder: &Path) -> String {
    let folder = folder.display();
    format!(
        "interrupted: the results are complete, the records are not; `lashloop campaign merge {folder}` completes them"
    )
}
