//! `lashloop campaign submit` and `status`: a campaign on a cluster, and how far it is.

use std::env;
use std::fs;
use std::path::{self, Path, PathBuf};
use std::time::{Duration, SystemTime};

use clap::Args;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::verdict::Exit;
use lashloop_campaign::CampaignError;
use lashloop_campaign::facts::{Facts, Program, program_sha256};
use lashloop_campaign::shard::{MAX_SHARDS, Shard};
use lashloop_campaign::shard_file::facts_path;

use super::campaign_run::REPORT_JSON;
use super::campaign_selection::SelectionOptions;
use super::error::{CliError, system};
use super::output::{complain, outln, prepare_folder, print_json};
use lashloop::Bench;
use lashloop_campaign::cluster::error::ClusterError;
use lashloop_campaign::cluster::jobs::{submit_merge, submit_shards};
use lashloop_campaign::cluster::progress::Progress;
use lashloop_campaign::cluster::scripts::{MERGE, SHARDS, Scripts};
use lashloop_campaign::cluster::slurm::{self, ranges};
use lashloop_campaign::cluster::submission::{FOLDER, Lock, Plan, Subject, Submission, check_shards};

#[derive(Args)]
pub(super) struct Submit {
    /// Campaign file in TOML
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// Submit to Slurm, by sbatch
    #[arg(long, required = true)]
    slurm: bool,

    /// Tasks of the array job; each runs one shard
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SHARDS)))]
    shards: u32,

    /// Folder for shards, results, scripts and logs, on a file system of all nodes
    #[arg(long, value_name = "DIR")]
    out: PathBuf,

    /// Drive, see `lashloop run --help`
    #[arg(long, default_value = "inproc", value_name = "DEVICE")]
    device: DeviceChoice,

    /// Print the plan and the job scripts, and change and submit nothing
    #[arg(long)]
    dry_run: bool,

    #[command(flatten)]
    selection: SelectionOptions,

    /// Features that a node must have, such as a rig
    #[arg(long, value_name = "FEATURES")]
    constraint: Option<String>,

    /// Licences that each job takes, such as rig:1
    #[arg(long, value_name = "LICENCES")]
    licenses: Option<String>,

    /// Partition of the cluster
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,

    /// Limit of each job, as sbatch reads it
    #[arg(long, value_name = "TIME")]
    time: Option<String>,

    /// A further option of sbatch, such as --sbatch=--mem=2G; repeatable
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    sbatch: Vec<String>,
}

#[derive(Args)]
pub(super) struct Status {
    /// Folder of the shards
    #[arg(value_name = "DIR")]
    folder: PathBuf,

    /// Age of the last row from which a shard counts as stale
    #[arg(long, value_name = "SECONDS", default_value_t = STALE_AFTER_S)]
    stale_after: u64,

    /// Print an object with cases and shards
    #[arg(long)]
    json: bool,
}

/// Longer than any run in process; a drive in real time may need more.
const STALE_AFTER_S: u64 = 600;

impl Submit {
    pub(super) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let options = self.options();
        let Self { file, slurm: _, shards, out, device, dry_run, selection, .. } = self;
        let campaign = selection.read(&file, bench)?;
        let cases = campaign.plan.cases();
        if u64::from(shards) > cases {
            return Err(ClusterError::Shards { shards, cases }.into());
        }
        let program = env::current_exe().map_err(system("find this program"))?;
        let sha256 = program_sha256().map_err(system("read this program"))?;
        let is_parallel = device.has_drive_per_session();
        let device = device.to_string();
        let subject = Subject::new(&campaign, sha256.clone(), device.clone(), shards);
        let drive = String::new();
        let program_facts =
            Program { lashloop: subject.lashloop.clone(), sha256, device: device.clone(), drive };
        let facts = Facts::new(&campaign, program_facts, shards);

        let absolute = |path: &Path| path::absolute(path).map_err(system("find the working folder"));
        let (file, out_path) = (absolute(&file)?, absolute(&out)?);
        let logs = out_path.join(FOLDER);
        let name = file.file_stem().map_or_else(|| "campaign".into(), |name| name.to_string_lossy());
        let working_folder = env::current_dir().map_err(system("find the working folder"))?;
        let scripts = Scripts {
            program: &program,
            name: &name,
            campaign: &file,
            out: &out_path,
            logs: &logs,
            working_folder: &working_folder,
            device: &device,
            is_parallel,
            selection: &campaign.selection,
            shards,
            options: &options,
        };
        if dry_run {
            if out_path.exists() {
                Submission::open(&out_path, subject)?;
                check_shards(&out_path, &facts)?;
            }
            let progress = read_progress(&out_path, shards, cases, STALE_AFTER_S)?;
            outln!("{progress}");
            for (name, text) in
                [(SHARDS, scripts.of_shards(&progress.unfinished())?), (MERGE, scripts.of_merge()?)]
            {
                outln!("\n# {}\n{text}", logs.join(name).display());
            }
            return Ok(Exit::Pass);
        }
        prepare_folder(&logs, &[])?;
        let _lock = Lock::take(&out_path)?;
        let mut submission = Submission::open(&out_path, subject)?;
        check_shards(&out_path, &facts)?;
        // In this order: a task that ends in between has a complete shard.
        let active = submission.active(&out_path, &slurm::queue()?);
        let progress = read_progress(&out_path, shards, cases, STALE_AFTER_S)?;
        let is_merged = out_path.join(REPORT_JSON).exists();
        let plan = Plan::new(&progress.unfinished(), &active, is_merged);
        if plan.shards.is_empty() && !plan.merge {
            outln!("{progress}");
            outln!(
                "nothing to submit: {}",
                if is_merged { "the shards are merged" } else { "the queue has the rest" }
            );
            return Ok(Exit::Pass);
        }

        let mut arrays = active.arrays;
        if !plan.shards.is_empty() {
            let array = submit_shards(&mut submission, &scripts, &plan.shards)?;
            outln!("job {array}: shards {} of {shards}, {cases} cases in all", ranges(&plan.shards));
            arrays.insert(array);
        }
        let merge = submit_merge(&mut submission, &scripts, &arrays)?;
        outln!("job {merge}: merge{}", if arrays.is_empty() { "" } else { ", after the last shard" });
        for (former, is_pending) in active.merges {
            if is_pending && let Err(error) = slurm::cancel_pending(former) {
                // It may have begun since, and then fails or merges the same shards.
                complain(format_args!("former merge {former} stays in the queue: {error}"));
            }
        }
        outln!(
            "`lashloop campaign status {0}` prints the progress; logs are in {0}/{FOLDER}; the same command submits shards \
             that failed",
            shlex::try_quote(&out.to_string_lossy()).unwrap_or_else(|_| out.to_string_lossy())
        );
        Ok(Exit::Pass)
    }

    fn options(&self) -> Vec<String> {
        let named = [
            ("constraint", &self.constraint),
            ("licenses", &self.licenses),
            ("partition", &self.partition),
            ("time", &self.time),
        ];
        let named =
            named.into_iter().filter_map(|(name, value)| Some(format!("--{name}={}", value.as_ref()?)));
        named.chain(self.sbatch.iter().cloned()).collect()
    }
}

impl Status {
    pub(super) fn run(self) -> Result<Exit, CliError> {
        let Self { folder, stale_after, json } = self;
        let (shards, cases) = extent(&folder)?;
        let progress = read_progress(&folder, shards, cases, stale_after)?;
        if json {
            print_json(&progress)?;
        } else {
            outln!("{progress}");
            let is_merged = folder.join(REPORT_JSON).exists();
            if is_merged && progress.unfinished().is_empty() {
                outln!("merged: {}", folder.join(REPORT_JSON).display());
            }
        }
        Ok(Exit::Pass)
    }
}

/// Shards and cases of a folder: as submitted, or as its first shard has it.
fn extent(folder: &Path) -> Result<(u32, u64), CliError> {
    if let Some(Submission { subject, .. }) = Submission::read(folder)? {
        return Ok((subject.shards, subject.cases));
    }
    let none = || CampaignError::NoShards { folder: folder.to_owned() };
    let entries = fs::read_dir(folder).map_err(|_| none())?;
    let mut shards = entries.filter_map(|entry| Shard::of_file_name(entry.ok()?.file_name().to_str()?));
    let facts = Facts::read(&facts_path(folder, shards.next().ok_or_else(none)?))?;
    Ok((facts.shards, facts.cases))
}

fn read_progress(folder: &Path, shards: u32, cases: u64, stale_after_s: u64) -> Result<Progress, CliError> {
    let stale_after = Duration::from_secs(stale_after_s);
    Ok(Progress::read(folder, shards, cases, stale_after, SystemTime::now())?)
}
