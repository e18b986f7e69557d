//! `lashloop battery`: control laws on plants outside their tuning.

use std::io::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::thread;

use crate::bench::Bench;
use crate::campaign::journal::Header;
use crate::campaign::law::Law;
use crate::campaign::plan::Settings;
use crate::campaign::{Campaign, CampaignError, table};
use crate::journal::{Journal, program_sha256};
use crate::workers::Ended;
use clap::Args;
use lashloop_bench::atomic_file::write_whole;
use lashloop_bench::verdict::Exit;

use super::error::{CliError, system};
use super::output::{self, outln, prepare_folder};
use super::progress::Progress;
use super::supervision::start_supervisor;

/// Run control laws on random and varied plants, in process and in parallel
///
/// First random plants (parameters within 30 % of their nominal values; gap, stiction and encoders over ranges of their
/// own), then the nominal plant with one quantity varied at a time. Exit code 1 if a law misses one of its limits on the
/// random plants.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Number of random plants
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    plants: u32,

    /// Seed of every random stream; equal seeds give equal plants and tables
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Control laws under test, separated by commas
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "pd,merzouki,backlash-inverse,braking-curve"
    )]
    controller: Vec<Law>,

    /// Omit the runs with one quantity varied
    #[arg(long)]
    no_sweeps: bool,

    /// Runs in parallel [default: number of cores]
    #[arg(long)]
    jobs: Option<NonZeroUsize>,

    /// Folder for the results: runs.jsonl during the battery, runs.csv and battery.json at its end
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Resume the battery in runs.jsonl
    #[arg(long, requires = "out")]
    resume: bool,
}

const JOURNAL: &str = "runs.jsonl";
const TABLE: &str = "runs.csv";
const REPORT: &str = "battery.json";

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let mut laws = self.controller.clone();
        laws.sort_unstable();
        laws.dedup();
        let settings = Settings { seed: self.seed, plants: self.plants, laws, sweeps: !self.no_sweeps };
        let mut campaign = Campaign::new(settings.clone())?;
        let mut journal = match &self.out {
            Some(folder) => Some(prepare(folder, self.resume, settings, &mut campaign)?),
            None => None,
        };
        let jobs = self.jobs.or_else(|| thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
        let supervisor = start_supervisor()?;
        let progress = Progress::over(format!("{} runs", campaign.total()), campaign.total() as u64);
        let mut done = campaign.done() as u64;
        progress.show(done);
        let signals = supervisor.guard_signals();
        let ended = campaign.run(jobs, &supervisor, |result| {
            done += 1;
            progress.show(done);
            journal.as_mut().map_or(Ok(()), |journal| journal.append(result))
        });
        drop(signals);
        drop(progress);
        if ended? == Ended::Interrupted {
            let (done, all) = (campaign.done(), campaign.total());
            let kept = match &self.out {
                Some(folder) => {
                    format!("kept in {}; resume with --resume", folder.join(JOURNAL).display())
                }
                None => "lost; --out keeps them".to_owned(),
            };
            outln!("interrupted: {done} of {all} runs are complete and {kept}");
            return Ok(Exit::Invalid);
        }
        let report = campaign.report();
        if let Some(folder) = &self.out {
            write_whole(&folder.join(TABLE), ".runs-", |file| table::write(file, campaign.results()))?;
            write_whole(&folder.join(REPORT), ".battery-", |file| {
                serde_json::to_writer_pretty(&mut *file, &report)?;
                file.write_all(b"\n")
            })?;
        }
        outln!("{report}");
        Ok(report.verdict.into())
    }
}

/// Opens the journal in its folder.
fn prepare(
    folder: &Path,
    resume: bool,
    settings: Settings,
    campaign: &mut Campaign,
) -> Result<Journal, CliError> {
    prepare_folder(folder, &[])?;
    let header = Header {
        lashloop: env!("CARGO_PKG_VERSION").to_owned(),
        program_sha256: program_sha256().map_err(system("read this program"))?,
        settings,
    };
    let path = folder.join(JOURNAL);
    let journal = if resume {
        let journal = Journal::resume(&path, &header, |result| campaign.take(result));
        let journal = journal.map_err(CampaignError::from)?;
        output::error_line(format_args!(
            "{} of {} runs restored from the journal",
            campaign.done(),
            campaign.total()
        ));
        journal
    } else {
        Journal::create(&path, &header).map_err(CampaignError::from)?
    };
    prepare_folder(folder, &[TABLE, REPORT])?;
    Ok(journal)
}
