//! `lashloop battery`: how control laws fare on plants they were not tuned for.

use std::fs;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::thread;

use clap::Args;
use lashloop::campaign::journal::{Header, Journal};
use lashloop::campaign::plan::{Law, Settings};
use lashloop::campaign::runs::Ended;
use lashloop::campaign::{Battery, BatteryError, table};
use lashloop_bench::atomic_file::write_whole;
use lashloop_bench::record::digest;
use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::progress::Progress;
use super::{output, start_supervisor};

/// Run control laws on many bench plants they were not tuned for, in process and in parallel.
///
/// Random plants, with every parameter up to 30 % from its nominal value, then the nominal plant with one thing varied at a
/// time. Ends with 1 if the backlash inverse misses one of its limits on the random plants.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Number of random plants
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    plants: u32,

    /// Starts every random stream: the same seed gives the same plants and the same tables
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Control laws, separated by commas
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "pd,merzouki,backlash-inverse")]
    controller: Vec<Law>,

    /// Leave the sweeps out
    #[arg(long)]
    no_sweeps: bool,

    /// Runs at a time; as many as there are cores by default
    #[arg(long)]
    jobs: Option<NonZeroUsize>,

    /// Keep the results in this folder: runs.jsonl as they come, then runs.csv and battery.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Go on with what is in runs.jsonl
    #[arg(long, requires = "out")]
    resume: bool,
}

const JOURNAL: &str = "runs.jsonl";
const TABLE: &str = "runs.csv";
const REPORT: &str = "battery.json";

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let mut laws = self.controller.clone();
        laws.sort_unstable();
        laws.dedup();
        let settings = Settings { seed: self.seed, plants: self.plants, laws, sweeps: !self.no_sweeps };
        let mut battery = Battery::new(settings.clone())?;
        let mut journal = match &self.out {
            Some(folder) => Some(prepare(folder, self.resume, settings, &mut battery)?),
            None => None,
        };
        let jobs = self.jobs.or_else(|| thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
        let supervisor = start_supervisor()?;
        let progress = Progress::over(format!("{} runs", battery.len()), battery.len() as u64);
        let mut done = battery.done() as u64;
        progress.show(done);
        let heed = supervisor.guard_signals();
        let ended = battery.run(jobs, &supervisor, |result| {
            done += 1;
            progress.show(done);
            journal.as_mut().map_or(Ok(()), |journal| journal.append(result))
        });
        drop(heed);
        drop(progress);
        if ended? == Ended::Interrupted {
            let (done, all) = (battery.done(), battery.len());
            let kept = match &self.out {
                Some(folder) => {
                    format!("kept in {}; --resume goes on with them", folder.join(JOURNAL).display())
                }
                None => "lost; with --out they would be kept".to_owned(),
            };
            say!("interrupted: {done} of {all} runs have been made and are {kept}");
            return Ok(Exit::Invalid);
        }
        let report = battery.report();
        if let Some(folder) = &self.out {
            write_whole(&folder.join(TABLE), ".runs-", |file| table::write(file, battery.results()))?;
            write_whole(&folder.join(REPORT), ".battery-", |file| {
                serde_json::to_writer_pretty(&mut *file, &report)?;
                file.write_all(b"\n")
            })?;
        }
        say!("{report}");
        Ok(report.verdict.into())
    }
}

/// Makes the folder and opens the journal. Tables of an earlier time go first: if this battery is cut short, they must not
/// stand beside its journal.
fn prepare(
    folder: &Path,
    resume: bool,
    settings: Settings,
    battery: &mut Battery,
) -> Result<Journal, CliError> {
    let failed = |source| CliError::Output { path: folder.to_owned(), source };
    fs::create_dir_all(folder).map_err(failed)?;
    let header = Header {
        lashloop: env!("CARGO_PKG_VERSION").to_owned(),
        program_sha256: program_sha256()
            .map_err(|source| CliError::System { what: "read this program", source })?,
        settings,
    };
    let path = folder.join(JOURNAL);
    let journal = if resume {
        let journal = Journal::resume(&path, &header, |result| battery.take(result));
        let journal = journal.map_err(BatteryError::from)?;
        output::error_line(format_args!(
            "{} of {} runs have been made before",
            battery.done(),
            battery.len()
        ));
        journal
    } else {
        Journal::create(&path, &header).map_err(BatteryError::from)?
    };
    for name in [TABLE, REPORT] {
        match fs::remove_file(folder.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(failed(error)),
            _ => {}
        }
    }
    Ok(journal)
}

/// Plant and drive are both in the file of this program, so results of another one may be others.
fn program_sha256() -> io::Result<String> {
    std::env::current_exe().and_then(fs::read).map(|bytes| digest::sha256(&bytes))
}
