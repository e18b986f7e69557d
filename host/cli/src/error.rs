//! The errors of commands and their exit codes.

use std::error::Error;
use std::io;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use lashloop::bode::BodeError;
use lashloop::execution::ExecutionError;
use lashloop::replay::ReplayError;
use lashloop::rig::RigError;
use lashloop::rig::lock::LockError;
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::DeviceError;
use lashloop_bench::process_plant::ProcessError;
use lashloop_bench::run::RunError;
use lashloop_bench::scenario::ScenarioErrors;
use lashloop_bench::verdict::Exit;
use lashloop_campaign::CampaignError;
use lashloop_campaign::budget::line_map::MapError;
use lashloop_campaign::cluster::error::ClusterError;
use lashloop_campaign::suite::baseline::BaselineError;
use lashloop_campaign::suite::files::FilesError;
use lashloop_fmu_export::ExportError as FmuExportError;
use lashloop_hardware::commission::MotionError;
use lashloop_hardware::flash::FlashError;
use lashloop_hardware::identify::record::NoSeries;
use lashloop_hardware::parameter_set::SettingsError;
use lashloop_identify::IdentifyError;
use lashloop_identify::electrical::ElectricalError;
use lashloop_identify::excitation::CommissioningError;
use lashloop_live::LiveError;
use lashloop_record::diff::DiffError;
use lashloop_record::export::ExportError;
use lashloop_record::folder::FolderError;
use lashloop_record::reader::ReadError;
use lashloop_record::table::TableError;
use lashloop_report::runs::DrawError;

use super::png::PngError;

/// An error of a command: one sentence for the user.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    #[error("{}: not one good frame; it isn't a stream of this protocol, or it begins with the data of another program", path.display())]
    NoMessage { path: PathBuf },
    #[error("--panel {panel}: a campaign has no signals; report the record of one of its runs")]
    PanelOfCampaign { panel: String },
    #[error("--core {core} can't be used: this process may run on {}", cores(usable))]
    Core { core: usize, usable: Vec<usize> },
    #[error("{option} needs --clock real-time; lockstep has no deadlines")]
    RealTimeAlone { option: &'static str },
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Loader(#[from] ProcessError),
    #[error("{}: can't be written: {source}; choose another folder with --out", path.display())]
    Output { path: PathBuf, source: io::Error },
    #[error("{}: can't be written: {source}; choose another file with {option}", path.display())]
    Report { path: PathBuf, option: &'static str, source: io::Error },
    #[error("{}: this output would replace a scenario or its baseline; name another file", path.display())]
    ReportOverInput { path: PathBuf },
    #[error(transparent)]
    Settings(SettingsError),
    #[error(
        "the drive has no memory for parameters (capability STORE): save them by `lashloop parameters dump` and set them by \
         `restore`"
    )]
    NoStore,
    #[error("{}: can't be read: {source}", path.display())]
    Input { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    #[error(transparent)]
    Cluster(#[from] ClusterError),
    #[error(transparent)]
    Map(#[from] MapError),
    #[error("{}: run.mode is \"hil\", so no plant is behind the pins; take a scenario with run.mode = \"bench\"", path.display())]
    NoPlantAtPins { path: PathBuf },
    #[error("--jobs {jobs} needs as many drives, and {what} is one: take --jobs 1")]
    Jobs { jobs: NonZeroUsize, what: String },
    #[error(transparent)]
    Files(#[from] FilesError),
    #[error(transparent)]
    Baseline(#[from] BaselineError),
    #[error("{} holds the results of an earlier `lashloop test`: --resume to complete it, --force to replace it", folder.display())]
    Leftovers { folder: PathBuf },
    #[error(transparent)]
    Record(#[from] ReadError),
    #[error(transparent)]
    Export(#[from] ExportError),
    #[error(transparent)]
    Fmu(#[from] FmuExportError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Folder(#[from] FolderError),
    #[error(transparent)]
    Diff(#[from] DiffError),
    #[error("{}: can't be run again: {problem}", record.display())]
    Rerun { record: PathBuf, problem: String },
    #[error(transparent)]
    Replay(#[from] ReplayError),
    #[error(transparent)]
    Draw(#[from] DrawError),
    #[error("PNG: {0}")]
    Picture(#[from] PngError),
    #[error("{}: has no sample of a run; it must be a capture of `run --capture`", path.display())]
    NoSteps { path: PathBuf },
    #[error("--from {from} --until {until} is an empty range; --until must be later than --from")]
    Nothing { from: f64, until: f64 },
    #[error("{}: its reference isn't constant, so nothing settles; give a scenario with one move", path.display())]
    NotConstant { path: PathBuf },
    #[error(transparent)]
    Bode(BodeError),
    #[error(transparent)]
    Live(#[from] LiveError),
    #[error(transparent)]
    Flash(#[from] FlashError),
    #[error(transparent)]
    Rig(#[from] RigError),
    #[error("the load at its start is not confirmed: press Enter at a terminal once it is there")]
    Unconfirmed,
    #[error("{option} {problem}")]
    CommissionLimit { option: &'static str, problem: String },
    #[error(transparent)]
    Commission(Box<CommissioningError<MotionError>>),
    #[error(transparent)]
    Electrical(Box<ElectricalError<MotionError>>),
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    #[error("{}: {source}", folder.display())]
    Motion { folder: PathBuf, source: NoSeries },
    #[error(
        "the counts per revolution of this record are not known, because {reason}; give --motor-counts-per-rev, \
         --load-counts-per-rev and --torque-delay-us"
    )]
    Instruments { reason: String },
    #[error("can't {what}: {source}")]
    System { what: &'static str, source: io::Error },
}

/// What the system refused, for `map_err`.
pub(crate) fn system<E: Into<Box<dyn Error + Send + Sync>>>(
    what: &'static str,
) -> impl FnOnce(E) -> CliError {
    move |error| CliError::System { what, source: io::Error::other(error) }
}

impl CliError {
    pub(crate) fn exit(&self) -> Exit {
        match self {
            Self::Campaign(CampaignError::Run { source, .. }) => source.exit(),
            Self::Campaign(CampaignError::NotRepeated { .. }) => Exit::Fail,
            Self::Run(error) => error.exit(),
            Self::Settings(SettingsError::Refused { .. } | SettingsError::Session(_))
            | Self::Replay(ReplayError::Device(_))
            | Self::System { .. } => Exit::DeviceOrLink,
            Self::Rig(error) => error.exit(),
            Self::Bode(BodeError::Plan(_)) => Exit::UsageOrScenario,
            Self::Bode(_) | Self::Commission(_) | Self::Electrical(_) | Self::Identify(_) => Exit::Invalid,
            Self::Flash(error) => flash_exit(error),
            Self::RealTimeAlone { .. }
            | Self::NoMessage { .. }
            | Self::PanelOfCampaign { .. }
            | Self::Core { .. }
            | Self::NoStore
            | Self::Unconfirmed
            | Self::Scenario(_)
            | Self::NoPlantAtPins { .. }
            | Self::Jobs { .. }
            | Self::Loader(_)
            | Self::Files(_)
            | Self::Baseline(_)
            | Self::Leftovers { .. }
            | Self::Campaign(_)
            | Self::Cluster(_)
            | Self::Map(_)
            | Self::Settings(_)
            | Self::Output { .. }
            | Self::Report { .. }
            | Self::ReportOverInput { .. }
            | Self::Input { .. }
            | Self::Record(_)
            | Self::Folder(_)
            | Self::Diff(_)
            | Self::Rerun { .. }
            | Self::Replay(_)
            | Self::Export(_)
            | Self::Fmu(_)
            | Self::Table(_)
            | Self::Draw(_)
            | Self::Picture(_)
            | Self::NoSteps { .. }
            | Self::Live(_)
            | Self::CommissionLimit { .. }
            | Self::Motion { .. }
            | Self::Instruments { .. }
            | Self::NotConstant { .. }
            | Self::Nothing { .. } => Exit::UsageOrScenario,
        }
    }
}

fn flash_exit(error: &FlashError) -> Exit {
    match error {
        error if error.is_interruption() => Exit::Invalid,
        FlashError::OtherBuild { .. }
        | FlashError::OtherBoard { .. }
        | FlashError::SameBuild { .. }
        | FlashError::NoBuild(_) => Exit::Fail,
        FlashError::Image(_)
        | FlashError::NoImage(_)
        | FlashError::NoBoard(_)
        | FlashError::Board { .. }
        | FlashError::Unnamed(_)
        | FlashError::Simulator(_)
        | FlashError::Ports(_) => Exit::UsageOrScenario,
        FlashError::NoWay(_)
        | FlashError::Unreached(_)
        | FlashError::AnotherChip { .. }
        | FlashError::Writing { .. }
        | FlashError::Different { .. }
        | FlashError::File { .. }
        | FlashError::Silent { .. }
        | FlashError::Unasked { .. } => Exit::DeviceOrLink,
    }
}

impl From<ExecutionError> for CliError {
    fn from(error: ExecutionError) -> Self {
        match error {
            ExecutionError::Rig(error) => Self::Rig(error),
            ExecutionError::Run(error) => Self::Run(error),
        }
    }
}

impl From<BodeError> for CliError {
    fn from(error: BodeError) -> Self {
        match error {
            BodeError::Run(error) => error.into(),
            error => Self::Bode(error),
        }
    }
}

impl From<lashloop::Error> for CliError {
    fn from(error: lashloop::Error) -> Self {
        match error {
            lashloop::Error::Scenario(errors) => Self::Scenario(errors),
            lashloop::Error::Run(error) => error.into(),
            other => system("simulate the loop")(other),
        }
    }
}

impl From<LockError> for CliError {
    fn from(error: LockError) -> Self {
        Self::Rig(error.into())
    }
}

impl From<DeviceError> for CliError {
    fn from(error: DeviceError) -> Self {
        Self::Run(error.into())
    }
}

impl From<WriteError> for CliError {
    fn from(error: WriteError) -> Self {
        Self::Run(error.into())
    }
}

/// Cores as a text.
fn cores(usable: &[usize]) -> String {
    let numbers: Vec<_> = usable.iter().map(ToString::to_string).collect();
    format!("core{} {}", if usable.len() == 1 { "" } else { "s" }, numbers.join(", "))
}
