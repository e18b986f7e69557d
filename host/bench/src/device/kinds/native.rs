//! `native`: the native twin, a process of its own on a pseudo-terminal.

use std::path::Path;

use super::terminal::open_terminal;
use crate::device::drive_host::{DriveHost, START_LIMIT, not_up, spawn};
use crate::device::error::DeviceError;
use crate::device::evidence::DriveFiles;
use crate::device::kind::{DeviceKind, Opened, Syntax};
use crate::supervisor::{Program, Supervisor};

const NAME: &str = "native";

pub(in crate::device) const SYNTAX: Syntax = Syntax {
    form: NAME,
    parse: |text| (text == NAME).then(|| Ok(Box::new(NativeTwin) as Box<dyn DeviceKind>)),
};

/// The native twin, started by the bench.
#[derive(Debug, Clone, Copy)]
pub struct NativeTwin;

impl DeviceKind for NativeTwin {
    fn name(&self) -> String {
        NAME.to_owned()
    }

    fn open(&self, _baud: u32, supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        if supervisor.bench.as_os_str().is_empty() {
            let problem = "a twin is started by a program with the command `device`, and this program has none; use inproc, or \
                           exec: with such a program";
            return Err(DeviceError::unreachable(self.name(), problem));
        }
        let program = Program {
            name: "native twin",
            program: supervisor.bench.clone().into(),
            arguments: vec!["device".into()],
            core: None,
        };
        let process = spawn(supervisor, &program)?;
        let Some(path) = process.first_line(START_LIMIT) else {
            return Err(not_up(&process));
        };
        // A pseudo-terminal has no baud rate.
        let link = open_terminal(Path::new(&path), 0)?;
        Ok(Opened { link, host: DriveHost::Process(process) })
    }

    fn files(&self, supervisor: &Supervisor) -> DriveFiles {
        DriveFiles { paths: vec![supervisor.bench.clone()], rebuilt_by: Some("cargo build") }
    }
}
