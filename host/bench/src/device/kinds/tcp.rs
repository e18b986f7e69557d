//! `tcp:HOST:PORT`: a drive behind a TCP port that passes bytes as they are.

use lashloop_link::Link;
use lashloop_link::reopening::Reopening;
use lashloop_link::tcp::{Address, connect_raw};

use crate::device::drive_host::DriveHost;
use crate::device::error::DeviceError;
use crate::device::kind::{DeviceKind, Opened, Syntax};
use crate::supervisor::Supervisor;

const PREFIX: &str = "tcp:";

pub(in crate::device) const SYNTAX: Syntax = Syntax {
    form: "tcp:HOST:PORT",
    parse: |text| {
        let address = text.strip_prefix(PREFIX)?.parse();
        Some(match address {
            Ok(address) => Ok(Box::new(TcpDrive { address }) as Box<dyn DeviceKind>),
            Err(problem) => Err(format!("{PREFIX} {problem}")),
        })
    },
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

    fn has_drive_per_session(&self) -> bool {
        false
    }

    fn open(&self, _baud: u32, _supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let address = self.address.clone();
        let open = move || connect_raw(&address).map(|socket| Box::new(socket) as Box<dyn Link>);
        match Reopening::new(open) {
            Ok(link) => Ok(Opened { link: Box::new(link), host: DriveHost::External }),
            Err(source) => Err(DeviceError::Connect { device: self.name(), source }),
        }
    }

    fn may_be_hardware(&self) -> bool {
        true
    }
}
