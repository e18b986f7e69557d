//! `lashloop paper battery`: control laws on plants outside their tuning.

use clap::Args;
use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::Exit;
use lashloop_campaign::Selection;
use lashloop_campaign::merge::RESULTS;
use lashloop_campaign::shard::Shard;
use lashloop_campaign::table::Table;
use lashloop_firmware::Laws;

use crate::campaign_run::{Concluded, RunsOptions, evidence_interrupted, jobs};
use crate::error::CliError;
use crate::options::plants;
use crate::output::outln;
use battery::campaign::{Battery, parse_law};
use battery::text::Tables;
use lashloop::Bench;

/// Run control laws on random and varied plants, in process and in parallel
///
/// First random plants (parameters within 30 % of their nominal values; gap, stiction and encoders over ranges of their
/// own), then the nominal plant with one quantity varied at a time. Exit code 1 if a law misses one of its limits on the
/// random plants. The campaign is campaigns/battery.toml; `lashloop campaign` runs others.
///
/// With --hard, motors, encoders and loads are real: offset, cogging and back-EMF of the torque, noise and eccentricity,
/// other loads and ratios, a load of two masses, LuGre friction, moves to and fro. That campaign is
/// campaigns/battery-hard.toml; only braking-curve has limits there.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Run the harder campaign
    #[arg(long)]
    hard: bool,

    /// Number of random plants in each part that has any
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    plants: u64,

    /// Seed of every random stream; equal seeds give equal plants and tables
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Control laws under test, separated by commas
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "pd,merzouki,backlash-inverse,braking-curve",
        value_parser = parse_law
    )]
    controller: Vec<String>,

    /// Omit the runs with one quantity varied
    #[arg(long)]
    no_sweeps: bool,

    #[command(flatten)]
    runs: RunsOptions,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let battery = if self.hard { Battery::Hard } else { Battery::Standard };
        let parts = if self.no_sweeps { battery.random_parts()? } else { Vec::new() };
        let selection = Selection {
            seed: Some(self.seed),
            set: Vec::new(),
            parts,
            variants: self.controller,
            points: Some(self.plants),
        };
        let campaign = battery.campaign(selection, &plants(bench))?;
        let device = InProcessDrive::<Laws>::default().into();
        let jobs = jobs(self.runs.jobs, &device, ClockName::Lockstep)?;
        self.runs.run(&campaign, &device, jobs, Shard::WHOLE, false, |execution| {
            let Some(Concluded { report, .. }) = execution.conclude()? else {
                outln!("{}", evidence_interrupted(execution.folder));
                return Ok(Exit::Invalid);
            };
            let verdict = report.verdict;
            let table = Table::new(&campaign, &execution.folder.join(RESULTS));
            outln!("{}", Tables::new(battery, report, &table)?);
            Ok(verdict.into())
        })
    }
}
