//! `tcp:HOST:PORT`: a drive behind a TCP port that passes bytes as they are.

use lashloop_link::Link;
use lashloop_link::reopening::Reopening;
use lashloop_link::tcp::{Address, connect_raw};

use crate::device::drive_host::DriveHost;
use crate::device::error::DeviceError;
use crate::device::kind::{DeviceKind, Opened, Syntax, after};
use crate::supervisor::Supervisor;

const PREFIX: &str = "tcp:";

pub(in crate::device) const SYNTAX: Syntax = Syntax {
    form: "tcp:HOST:PORT",
    parse: |text| after(PREFIX, text, |text| text.parse().map(|address| TcpDrive { address })),
};

/// A drive behind a TCP port: ser2net's raw mode, an emulator, or a drive with a socket of its own.
#[derive(Debug, Clone)]
pub struct TcpDrive {
    /// Where the server listens.
    pub address: Address,
}

impl DeviceKind for TcpDrive {
    fn name(&self) -> String {
        format!("{PREFIX}{}", self.address)
    }

    fn open(&self, _baud: u32, _supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let address = self.address.clone();
        let open = move || connect_raw(&address).map(|socket| Box::new(socket) as Box<dyn Link>);
        match Reopening::new(open) {
            Ok(link) => Ok(Opened { link: Box::new(link), host: DriveHost::External }),
            Err(problem) => Err(DeviceError::unreachable(self.name(), problem)),
        }
    }

    fn may_be_hardware(&self) -> bool {
        true
    }
}
