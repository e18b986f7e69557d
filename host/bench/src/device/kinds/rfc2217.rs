//! `rfc2217:HOST:PORT`: a serial port of another machine. A name of its own, because the first bytes don't distinguish raw
//! from telnet: a raw server would pass the negotiation on to the drive.

use lashloop_link::Link;
use lashloop_link::reopening::Reopening;
use lashloop_link::rfc2217::Rfc2217;
use lashloop_link::tcp::{Address, connect};

use crate::device::drive_host::DriveHost;
use crate::device::error::DeviceError;
use crate::device::kind::{DeviceKind, Opened, Syntax, after};
use crate::supervisor::Supervisor;

const PREFIX: &str = "rfc2217:";

pub(in crate::device) const SYNTAX: Syntax = Syntax {
    form: "rfc2217:HOST:PORT",
    parse: |text| after(PREFIX, text, |text| text.parse().map(|address| RemotePort { address })),
};

/// A drive on a serial port of another machine, behind an RFC 2217 server.
#[derive(Debug, Clone)]
pub struct RemotePort {
    /// Where the server listens.
    pub address: Address,
}

impl DeviceKind for RemotePort {
    fn name(&self) -> String {
        format!("{PREFIX}{}", self.address)
    }

    fn open(&self, baud: u32, _supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        let (address, device) = (self.address.clone(), self.name());
        let open = move || {
            let socket = connect(&address).map_err(|problem| DeviceError::unreachable(&device, problem))?;
            let port = Rfc2217::open(Box::new(socket), baud);
            let port = port.map_err(|problem| DeviceError::unreachable(&device, problem))?;
            Ok::<_, DeviceError>(Box::new(port) as Box<dyn Link>)
        };
        Ok(Opened { link: Box::new(Reopening::new(open)?), host: DriveHost::External })
    }

    fn may_be_hardware(&self) -> bool {
        true
    }

    fn check_modelled_uart(&self, baud: u32) -> Result<(), DeviceError> {
        Err(DeviceError::has_uart(self.name(), baud))
    }
}
