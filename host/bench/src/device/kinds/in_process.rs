//! `inproc`: the drive in this process, called directly.

use crate::device::drive_host::DriveHost;
use crate::device::error::DeviceError;
use crate::device::kind::{DeviceKind, Opened, Syntax};
use crate::link::in_process::InProcess;
use crate::supervisor::Supervisor;

const NAME: &str = "inproc";

pub(in crate::device) const SYNTAX: Syntax = Syntax {
    form: NAME,
    parse: |text| (text == NAME).then(|| Ok(Box::new(InProcessDrive) as Box<dyn DeviceKind>)),
};

/// The drive in this process.
#[derive(Debug, Clone, Copy)]
pub struct InProcessDrive;

impl DeviceKind for InProcessDrive {
    fn name(&self) -> String {
        NAME.to_owned()
    }

    fn open(&self, _baud: u32, _supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let link = InProcess::default();
        let host = DriveHost::InProcess(link.suspension.clone());
        Ok(Opened { link: Box::new(link), host })
    }
}
