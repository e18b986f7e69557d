//! A rig that this program uses alone.

use std::path::Path;

use lashloop_bench::device::{Device, DeviceChoice, DeviceError, Syntax};
use lashloop_bench::run::takes_torque;
use lashloop_bench::scenario::{Scenario, ScenarioErrors};
use lashloop_bench::verdict::Exit;
use lashloop_session::{Session, printable};

use super::drive_settings::MissingParameter;
use super::file::Rig;
use super::limits::{Excess, LimitError};
use super::lock::{LockError, RigLock};

/// Why a rig can't be used.
#[derive(Debug, thiserror::Error)]
pub enum RigError {
    /// The rig file is wrong, each error with its place.
    #[error(transparent)]
    File(#[from] ScenarioErrors),
    /// Another program uses the rig.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// Its port doesn't exist.
    #[error("{problem}")]
    Absent {
        /// The port, and what to do.
        problem: String,
    },
    /// The scenario exceeds its limits.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// Its drive lacks a parameter.
    #[error(transparent)]
    Parameter(#[from] MissingParameter),
}

impl RigError {
    /// The exit code of a command that fails so.
    #[must_use]
    pub fn exit(&self) -> Exit {
        match self {
            Self::File(_) | Self::Limit(_) => Exit::UsageOrScenario,
            Self::Lock(_) | Self::Parameter(_) => Exit::DeviceOrLink,
            Self::Absent { .. } => Exit::HardwareAbsent,
        }
    }
}

/// A rig that this program uses alone.
pub struct TakenRig {
    /// What the rig file says.
    pub rig: Rig,
    _lock: RigLock,
}

impl TakenRig {
    /// Reads and locks a rig. `purpose` is what the program does, for the message of a second program.
    ///
    /// # Errors
    /// The rig file is wrong, or another program uses the rig.
    pub fn take(file: &Path, devices: &[Syntax], purpose: &str) -> Result<Self, RigError> {
        let rig = Rig::from_file(file, &|text| DeviceChoice::parse(text, devices))?;
        let lock = RigLock::take(&rig.port.without_limits().to_string(), &format!("lashloop {purpose}"))?;
        Ok(Self { rig, _lock: lock })
    }
}

impl Rig {
    /// The sentence about a rig whose port doesn't exist; `None` for a port that exists, or that isn't of this machine.
    #[must_use]
    pub fn absent(&self) -> Option<String> {
        let port = self.port.without_limits().terminal()?;
        let exists = port.exists();
        (!exists).then(|| {
            format!(
                "hardware absent: there is no {} on this machine; plug in the rig, see `lashloop doctor`, or ask {}",
                port.display(),
                self.contact
            )
        })
    }

    /// # Errors
    /// The port of the rig doesn't exist.
    pub fn check_present(&self) -> Result<(), RigError> {
        self.absent().map_or(Ok(()), |problem| Err(RigError::Absent { problem }))
    }

    /// Rejects a drive on another board than that of the rig.
    ///
    /// # Errors
    /// The boards differ.
    pub fn check_board(&self, device: &Device) -> Result<(), DeviceError> {
        let board = device.session.identity.board;
        if board.as_str() == self.board {
            return Ok(());
        }
        let (file, has) = (self.file.display(), printable(board.as_str()));
        Err(device.unfit(format!("its board is {has}, that of {file} is {}", self.board)))
    }

    /// The scenario at the speed of the rig's port.
    pub(crate) fn on_line(&self, scenario: &Scenario) -> Scenario {
        let mut scenario = scenario.clone();
        scenario.link.baud = self.port.baud;
        scenario
    }

    /// Checks a reference that the law takes as a position, by the drive's description. A torque has no travel: the drive limits
    /// it, and in bench mode the run ends where the load leaves the travel.
    ///
    /// # Errors
    /// The reference exceeds travel or speed.
    pub(crate) fn check_reference(&self, scenario: &Scenario, session: &Session) -> Result<(), RigError> {
        if takes_torque(scenario, session) {
            return Ok(());
        }
        Ok(self.limits.check_reference(scenario, &self.file)?)
    }

    /// Bounds a scenario by the limits, and completes it for this drive.
    ///
    /// # Errors
    /// The scenario exceeds a limit, or the drive lacks the parameter of one.
    pub(crate) fn bound(
        &self,
        scenario: &mut Scenario,
        session: &Session,
        excess: Excess,
    ) -> Result<(), RigError> {
        match excess {
            Excess::Rejected => {
                self.allows(scenario)?;
                self.check_reference(scenario, session)?;
            }
            Excess::Guarded => {
                let _ = self.limits.reduce(scenario);
            }
        }
        scenario.link.baud = self.port.baud;
        self.complete(scenario, &session.parameters)?;
        if excess == Excess::Guarded {
            scenario.bench.load_travel_limit_rad = None;
        }
        Ok(())
    }
}
