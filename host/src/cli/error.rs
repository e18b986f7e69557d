//! The errors of commands and their exit codes.

use std::error::Error;
use std::io;
use std::path::PathBuf;

use crate::campaign::CampaignError;
use crate::commission::MotionError;
use crate::flash::FlashError;
use crate::identify::record::NoSeries;
use crate::parameter_set::SettingsError;
use crate::rig::drive_settings::MissingParameter;
use crate::rig::limits::LimitError;
use crate::rig::lock::LockError;
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::DeviceError;
use lashloop_bench::run::RunError;
use lashloop_bench::scenario::ScenarioErrors;
use lashloop_bench::verdict::Exit;
use lashloop_identify::IdentifyError;
use lashloop_identify::excitation::CommissioningError;
use lashloop_record::folder::FolderError;
use lashloop_record::reader::ReadError;
use lashloop_report::runs::DrawError;

/// An error of a command: one sentence for the user.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    #[error("{option} needs --clock real-time; lockstep has no deadlines")]
    RealTimeAlone { option: &'static str },
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error("{}: can't be written: {source}; choose another folder with --out", path.display())]
    Output { path: PathBuf, source: io::Error },
    #[error("{}: can't be written: {source}; choose another file with --junit", path.display())]
    Report { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Settings(SettingsError),
    #[error("{}: can't be read: {source}", path.display())]
    Input { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    #[error(transparent)]
    Record(#[from] ReadError),
    #[error(transparent)]
    Folder(#[from] FolderError),
    #[error(transparent)]
    Draw(#[from] DrawError),
    #[error("--from {from} --until {until} is an empty range; --until must be later than --from")]
    Nothing { from: f64, until: f64 },
    #[error(transparent)]
    Flash(#[from] FlashError),
    #[error("{problem}")]
    HardwareAbsent { problem: String },
    #[error(transparent)]
    RigLock(#[from] LockError),
    #[error(transparent)]
    RigLimit(#[from] LimitError),
    #[error(transparent)]
    RigParameter(#[from] MissingParameter),
    #[error("the load at its start is not confirmed: press Enter at a terminal once it is there")]
    Unconfirmed,
    #[error("{option} {problem}")]
    CommissionLimit { option: &'static str, problem: String },
    #[error(transparent)]
    Commission(Box<CommissioningError<MotionError>>),
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
            Self::Campaign(CampaignError::Run { source, .. }) if matches!(**source, RunError::Device(_)) => {
                Exit::DeviceOrLink
            }
            Self::Run(RunError::Device(DeviceError::NoScale { .. })) => Exit::UsageOrScenario,
            Self::Run(RunError::Device(_))
            | Self::Settings(SettingsError::Refused { .. } | SettingsError::Session(_))
            | Self::RigLock(_)
            | Self::RigParameter(_)
            | Self::System { .. } => Exit::DeviceOrLink,
            Self::HardwareAbsent { .. } => Exit::HardwareAbsent,
            Self::Commission(_) | Self::Identify(_) => Exit::Invalid,
            Self::Flash(error) => flash_exit(error),
            Self::RealTimeAlone { .. }
            | Self::Unconfirmed
            | Self::Scenario(_)
            | Self::Run(_)
            | Self::Campaign(_)
            | Self::Settings(_)
            | Self::Output { .. }
            | Self::Report { .. }
            | Self::Input { .. }
            | Self::Record(_)
            | Self::Folder(_)
            | Self::Draw(_)
            | Self::CommissionLimit { .. }
            | Self::Motion { .. }
            | Self::Instruments { .. }
            | Self::RigLimit(_)
            | Self::Nothing { .. } => Exit::UsageOrScenario,
        }
    }
}

fn flash_exit(error: &FlashError) -> Exit {
    match error {
        error if error.is_interruption() => Exit::Invalid,
        FlashError::OtherBuild { .. } | FlashError::NoBuild { .. } => Exit::Fail,
        FlashError::Image(_) | FlashError::NoImage(_) | FlashError::Ports(_) => Exit::UsageOrScenario,
        FlashError::NoWay(_)
        | FlashError::Unreached(_)
        | FlashError::Writing { .. }
        | FlashError::Different { .. }
        | FlashError::File { .. }
        | FlashError::Silent { .. } => Exit::DeviceOrLink,
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
