//! Where a run happens.

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::scenario::Scenario;

use crate::rig::{RigError, TakenRig};

/// Where a run happens: on a device, or on a rig, which has limits.
#[derive(Clone, Copy)]
pub enum Place<'a> {
    /// A device as the user named it.
    Device(&'a DeviceChoice),
    /// A bench with hardware.
    Rig(&'a TakenRig),
}

impl<'a> Place<'a> {
    /// The rig, if there is one, else the device.
    #[must_use]
    pub fn of(rig: Option<&'a TakenRig>, device: &'a DeviceChoice) -> Self {
        rig.map_or(Self::Device(device), Self::Rig)
    }

    /// How the user named it, for messages and questions.
    #[must_use]
    pub fn choice(self) -> &'a DeviceChoice {
        match self {
            Self::Device(device) => device,
            Self::Rig(taken) => taken.rig.port.without_limits(),
        }
    }

    /// Checks what can be known before anything is opened. Opening repeats it.
    ///
    /// # Errors
    /// The rig is absent, or the scenario exceeds it.
    pub fn check(self, scenario: &Scenario) -> Result<(), RigError> {
        let Self::Rig(taken) = self else { return Ok(()) };
        taken.rig.allows(scenario)?;
        taken.rig.check_present()
    }

    /// The rig file as the user named it, for the record; `None` on a device.
    #[must_use]
    pub fn rig_file(self) -> Option<String> {
        self.rig().map(|taken| taken.rig.file.display().to_string())
    }

    /// The rig; `None` on a device.
    #[must_use]
    pub fn rig(self) -> Option<&'a TakenRig> {
        match self {
            Self::Device(_) => None,
            Self::Rig(taken) => Some(taken),
        }
    }
}

impl<'a> From<&'a DeviceChoice> for Place<'a> {
    fn from(device: &'a DeviceChoice) -> Self {
        Self::Device(device)
    }
}

impl<'a> From<&'a TakenRig> for Place<'a> {
    fn from(rig: &'a TakenRig) -> Self {
        Self::Rig(rig)
    }
}
