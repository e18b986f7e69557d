//! `lashloop campaign`: many runs of a scenario over plants, links and laws, in shards, merged to one table and a verdict.

use std::path::{Path, PathBuf};

use clap::{ArgAction, Args, Parser, Subcommand};
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::Exit;
use lashloop_campaign::evidence;
use lashloop_campaign::facts::{CAMPAIGN, Facts};
use lashloop_campaign::file::CampaignFile;
use lashloop_campaign::merge::{RESULTS, common_facts};
use lashloop_campaign::shard::{Shard, ShardChoice};
use lashloop_campaign::shard_file::shards_in;
use lashloop_campaign::table::Table;
use lashloop_campaign::{Campaign, CampaignError};
use lashloop_record::folder::RecordFolder;
use lashloop_session::counted;

use super::campaign_run::{Concluded, Execution, RunsOptions, begin_merge, evidence_interrupted, jobs};
use super::campaign_selection::SelectionOptions;
use super::campaign_submit::{Status, Submit};
use super::error::{CliError, system};
use super::log_to_standard_error;
use super::options::plants;
use super::output::{error_line, outln, program_name};
use super::supervision::start_supervisor;
use lashloop::Bench;

/// Run a scenario over many plants, links or laws, and judge statistics over the runs
///
/// Case i is a function of campaign file, seed and i. Results are therefore the same for any number of jobs and shards.
/// `lashloop campaign FILE.toml` is `lashloop campaign run FILE.toml`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Run the cases of a campaign, or one shard of them
    ///
    /// Without --shard the results are merged and reported at once. Exit code 1 if an expectation of the campaign is missed.
    Run(RunArguments),
    /// Submit the shards of a campaign to a cluster, and their merge; again, those that failed
    ///
    /// Writes the job scripts into DIR/slurm. A second command on the same folder submits only shards that are neither complete
    /// nor in the queue.
    Submit(Submit),
    /// Print how far the shards in a folder are, from their files alone
    Status(Status),
    /// Merge the shards in a folder to results.csv, and report
    ///
    /// Rejects shards that are missing, incomplete, of another campaign, or of another program or drive.
    Merge {
        /// Folder of the shards
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Print what a campaign consists of, or the settings of one case
    Show {
        /// Campaign file in TOML
        #[arg(value_name = "FILE")]
        file: PathBuf,

        /// Print the scenario and settings of this case, from 0
        #[arg(long, value_name = "I")]
        case: Option<u64>,

        #[command(flatten)]
        selection: SelectionOptions,
    },
    /// Run a row of the results again and compare its torques
    Rerun {
        /// Folder of the results, or results.csv in it
        #[arg(value_name = "DIR")]
        results: PathBuf,

        /// The case, from 0
        #[arg(long, value_name = "I")]
        case: u64,

        /// Folder for the record of the run [default: none is kept]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,

        /// Replace the record that the folder of --out holds
        #[arg(long, requires = "out")]
        force: bool,
    },
    #[command(external_subcommand)]
    File(Vec<String>),
    /// Print every key of a campaign file with unit, range, default and meaning, as Markdown
    Keys {
        /// As a JSON Schema for editors
        #[arg(long)]
        schema: bool,
    },
}

/// `lashloop campaign FILE.toml`, which is `lashloop campaign run FILE.toml`.
#[derive(Parser)]
struct RunLine {
    /// As of every command
    #[arg(short, long, action = ArgAction::Count)]
    verbose: u8,

    #[command(flatten)]
    arguments: RunArguments,
}

#[derive(Args)]
struct RunArguments {
    /// Campaign file in TOML: scenario, parts with their axes, expectations
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// Shard K of N, from 1, with the cases i of which i mod N is K - 1; `auto` takes it from the environment of Slurm, of a
    /// CI matrix or of a Kubernetes job
    #[arg(long, value_name = "K/N", requires = "out")]
    shard: Option<ShardChoice>,

    /// Number of shards, for a Kubernetes job, which does not set it
    #[arg(long, value_name = "N", requires = "shard")]
    shards: Option<u32>,

    /// Drive, see `lashloop run --help`; each run has a drive of its own
    #[arg(long, default_value = "inproc", value_name = "DEVICE")]
    device: DeviceChoice,

    #[command(flatten)]
    selection: SelectionOptions,

    #[command(flatten)]
    runs: RunsOptions,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        match self.verb {
            Verb::Run(arguments) => arguments.run(bench),
            Verb::Submit(submit) => submit.run(bench),
            Verb::Status(status) => status.run(),
            Verb::Merge { folder } => {
                // A folder without shards may hold other reports.
                if shards_in(&folder)?.is_empty() {
                    return Err(CampaignError::NoShards { folder }.into());
                }
                let lock = begin_merge(&folder)?;
                let facts = common_facts(&folder)?;
                let (campaign, device) = (facts.campaign(&plants(bench))?, device(&facts, bench)?);
                let supervisor = start_supervisor()?;
                let execution = Execution {
                    campaign: &campaign,
                    device: &device,
                    folder: &folder,
                    supervisor: &supervisor,
                    is_kept: true,
                };
                report(&execution, execution.conclude_locked(&lock)?)
            }
            Verb::Show { file, case, selection } => show(&selection.read(&file, bench)?, case),
            Verb::Rerun { results, case, out, force } => rerun(&results, case, out.as_deref(), force, bench),
            Verb::File(words) => {
                let file = words.first().cloned().unwrap_or_default();
                if Path::new(&file).extension().is_some_and(|extension| extension == "toml") {
                    let line = [format!("{} campaign run", program_name())].into_iter().chain(words);
                    let RunLine { verbose, arguments } = RunLine::parse_from(line);
                    log_to_standard_error(verbose);
                    return arguments.run(bench);
                }
                let problem =
                    "is neither a command of `lashloop campaign`, see --help, nor a campaign file, FILE.toml";
                Err(CampaignError::Unusable { file, problem: problem.to_owned() }.into())
            }
            Verb::Keys { schema } => {
                let keys = CampaignFile::keys();
                let page = || keys.to_page(KEYS).trim_end().to_owned();
                let schema = schema.then(|| format!("{:#}", keys.to_json_schema_of("Lashloop campaign")));
                outln!("{}", schema.unwrap_or_else(page));
                Ok(Exit::Pass)
            }
        }
    }
}

const KEYS: &str = "\
# Keys of campaign files

Generated by `lashloop campaign keys` from the declarations of the reader; [campaigns.md](campaigns.md) has examples and rules.
";

impl RunArguments {
    fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let environment = |name: &str| std::env::var(name).ok();
        let shard = self.shard.map(|choice| choice.resolve(environment, self.shards)).transpose();
        let shard = shard.map_err(CampaignError::from)?;
        let jobs = jobs(self.runs.jobs, &self.device, ClockName::Lockstep)?;
        let campaign = self.selection.read(&self.file, bench)?;
        let of = shard.unwrap_or(Shard::WHOLE);
        self.runs.run(&campaign, &self.device, jobs, of, true, |execution| {
            let Some(shard) = shard else { return report(execution, execution.conclude()?) };
            outln!(
                "shard {shard} is complete: {}; `lashloop campaign merge {}` merges all shards",
                counted(shard.len(campaign.plan.cases()), "run"),
                execution.folder.display()
            );
            Ok(Exit::Pass)
        })
    }
}

fn report(execution: &Execution<'_>, concluded: Option<Concluded>) -> Result<Exit, CliError> {
    let Some(Concluded { report, failures_without_record }) = concluded else {
        outln!("{}", evidence_interrupted(execution.folder));
        return Ok(Exit::Invalid);
    };
    outln!("{report}");
    failures_without_record.iter().for_each(|text| error_line(format_args!("{text}")));
    Ok(report.verdict.into())
}

/// The device of a merged campaign.
fn device(facts: &Facts, bench: &Bench) -> Result<DeviceChoice, CliError> {
    DeviceChoice::parse(&facts.device, &bench.devices()).map_err(system("use the device of the campaign"))
}

fn show(campaign: &Campaign, case: Option<u64>) -> Result<Exit, CliError> {
    if let Some(number) = case {
        let case = campaign.case(number)?;
        let part = &campaign.file.parts[case.part].name;
        let variant = &campaign.variants[case.variant].name;
        outln!("case {number}: part {part}, row {}, variant {variant}", case.row);
        outln!("scenario {}", campaign.scenario_source(&case).path);
        for setting in campaign.overrides(&case) {
            outln!("{setting}");
        }
        campaign.scenario(&case)?;
        return Ok(Exit::Pass);
    }
    let file = &campaign.file;
    outln!("{}: {}, seed {}", file.title, counted(campaign.plan.cases(), "case"), file.seed);
    for (index, part) in file.parts.iter().enumerate() {
        let axes: Vec<_> = part.axes.iter().map(|axis| axis.keys.join(" = ")).collect();
        outln!(
            "part {}: {} rows, {:?}, axes {}",
            part.name,
            campaign.plan.rows(index),
            part.method,
            axes.join(", ")
        );
    }
    let variants: Vec<_> = campaign.variants.iter().map(|variant| variant.name.as_str()).collect();
    outln!("variants {}", variants.join(", "));
    outln!("{} expectations", file.expectations.len());
    Ok(Exit::Pass)
}

fn rerun(
    results: &Path,
    case: u64,
    out: Option<&Path>,
    force: bool,
    bench: &Bench,
) -> Result<Exit, CliError> {
    let folder = if results.is_dir() { results } else { results.parent().unwrap_or(Path::new("")) };
    let facts = Facts::read(&folder.join(CAMPAIGN))?;
    let (campaign, device) = (facts.campaign(&plants(bench))?, device(&facts, bench)?);
    let record = out.map(|out| RecordFolder::claim(out, force)).transpose()?;
    let supervisor = start_supervisor()?;
    let execution =
        Execution { campaign: &campaign, device: &device, folder, supervisor: &supervisor, is_kept: true };
    let pick = evidence::pick(&Table::new(&campaign, &folder.join(RESULTS)), case)?;
    let signals = supervisor.guard_signals();
    let result = execution.repeater().repeat(&pick, record)?;
    drop(signals);
    let Some(result) = result else { return Ok(Exit::Invalid) };
    outln!(
        "case {case}: {}, {}; the row is as in the table, torque digest {}",
        result.verdict,
        result.end,
        result.torque_sha256
    );
    Ok(Exit::Pass)
}
