//! A path: the drive on a serial port, or on a pseudo-terminal of another program.

use std::io;
use std::path::{Path, PathBuf};

use lashloop_link::latency_timer::LatencyTimer;
use lashloop_link::pty::{self, Pty};
use lashloop_link::reopening::Reopening;
use lashloop_link::same_adapter::same_adapter;
use lashloop_link::serial::Serial;
use lashloop_link::usb_adapter::UsbAdapter;
use lashloop_link::{Link, LinkError};

use crate::device::drive_host::DriveHost;
use crate::device::error::DeviceError;
use crate::device::kind::{DeviceKind, Opened, Syntax};
use crate::supervisor::Supervisor;

pub(in crate::device) const SYNTAX: Syntax = Syntax {
    form: "the path of a terminal like /dev/ttyACM0",
    parse: |text| {
        let kind = || Ok(Box::new(TerminalDrive { path: text.into() }) as Box<dyn DeviceKind>);
        text.contains('/').then(kind)
    },
};

/// The drive on a terminal.
#[derive(Debug, Clone)]
pub struct TerminalDrive {
    /// Path of the terminal.
    pub path: PathBuf,
}

impl DeviceKind for TerminalDrive {
    fn name(&self) -> String {
        self.path.display().to_string()
    }

    fn open(&self, baud: u32, _supervisor: &Supervisor) -> Result<Opened, DeviceError> {
        Ok(Opened { link: open_terminal(&self.path, baud)?, host: DriveHost::External })
    }

    fn terminal(&self) -> Option<&Path> {
        Some(&self.path)
    }

    fn may_be_hardware(&self) -> bool {
        true
    }

    fn check_modelled_uart(&self, baud: u32) -> Result<(), DeviceError> {
        let resolved =
            self.path.canonicalize().map_err(|error| DeviceError::not_opened(&self.path, &error))?;
        if is_pseudo_terminal(&resolved) { Ok(()) } else { Err(DeviceError::has_uart(self.name(), baud)) }
    }
}

/// Opens and locks a pseudo-terminal or a serial port. `baud` is in bits per second and is for serial ports alone. The latency
/// timer of a USB adapter is shortened whenever the port is opened: after a reconnect it has its default again.
///
/// # Errors
/// `path` is missing, isn't a terminal, or another program holds it.
pub fn open_terminal(path: &Path, baud: u32) -> Result<Box<dyn Link>, DeviceError> {
    let name = path.to_owned();
    let mut adapter = None;
    let open = move || -> Result<Box<dyn Link>, OpenError> {
        // Resolved on every opening: a name under /dev/serial/by-id may point to another file after a reconnect.
        let path = name.canonicalize()?;
        if is_pseudo_terminal(&path) {
            return Ok(Box::new(Pty::open(&path)?));
        }
        // Before the port is opened, because DTR resets many boards.
        adapter = same_adapter(adapter.as_ref(), UsbAdapter::at(&path))?;
        let port = Serial::open(&path, baud)?;
        let _ = LatencyTimer::shorten(&path);
        Ok(Box::new(port))
    };
    match Reopening::explaining(open, OpenError::into_link_error) {
        Ok(link) => Ok(Box::new(link)),
        Err(OpenError::System(error)) => Err(DeviceError::not_opened(path, &error)),
        Err(OpenError::Adapter(error)) => Err(DeviceError::unreachable(path.display(), error)),
    }
}

/// Why a terminal can't be opened.
enum OpenError {
    System(io::Error),
    /// [`LinkError::OtherAdapter`] after a reconnect.
    Adapter(LinkError),
}

impl OpenError {
    /// The error of a reconnect. A port that the system doesn't open yet is still disconnected.
    fn into_link_error(self) -> LinkError {
        match self {
            Self::System(_) => LinkError::Disconnected,
            Self::Adapter(error) => error,
        }
    }
}

impl From<io::Error> for OpenError {
    fn from(error: io::Error) -> Self {
        Self::System(error)
    }
}

impl From<LinkError> for OpenError {
    fn from(error: LinkError) -> Self {
        Self::Adapter(error)
    }
}

fn is_pseudo_terminal(resolved: &Path) -> bool {
    resolved.starts_with(pty::DIRECTORY)
}
