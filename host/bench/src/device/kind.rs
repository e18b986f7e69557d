//! One way to reach a drive.

use std::fmt;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use lashloop_link::Link;

use super::drive_host::DriveHost;
use super::error::DeviceError;
use super::evidence::DriveFiles;
use super::pin_plant::PinPlant;
use crate::supervisor::Supervisor;
use crate::timing::ClockName;

/// One way to reach a drive.
pub trait DeviceKind: fmt::Debug + Send + Sync {
    /// The text that a user names it by.
    fn name(&self) -> String;

    /// Starts what has to be started and opens the link. Nothing is sent to the drive. `baud` is in bits per second and
    /// is for serial ports alone.
    ///
    /// # Errors
    /// What can't be started or opened, and what to do.
    fn open(&self, baud: u32, supervisor: &Supervisor) -> Result<Opened, DeviceError>;

    /// Path of the terminal that the drive is at; `None` for a drive that is reached in another way.
    fn terminal(&self) -> Option<&Path> {
        None
    }

    /// Whether the drive may be hardware, one for all sessions. By default each session has a simulator of its own.
    fn may_be_hardware(&self) -> bool {
        false
    }

    /// This device with a plant behind the pins of its drive; `None` for a drive whose pins are wired to hardware.
    ///
    /// # Errors
    /// What the device needs to know of the plant, and what to do.
    fn with_plant(&self, pins: &PinPlant) -> Result<Option<Box<dyn DeviceKind>>, DeviceError> {
        let _ = pins;
        Ok(None)
    }

    /// Whether the device runs in bench mode under this clock. By default its drive has a time of its own.
    fn keeps_bench_clock(&self, clock: ClockName) -> bool {
        clock == ClockName::RealTime
    }

    /// Number of the first session. The default is unlike any earlier one, of which frames may still be on the line.
    fn session_number(&self) -> u32 {
        session_number()
    }

    /// Checks that a UART may be modelled on this link: that it has none of its own. `baud` is the speed it has otherwise.
    ///
    /// # Errors
    /// The link has a UART of its own.
    fn check_modelled_uart(&self, baud: u32) -> Result<(), DeviceError> {
        let _ = baud;
        Ok(())
    }

    /// The files that run as the drive; none for a drive that the bench did not start.
    fn files(&self, supervisor: &Supervisor) -> DriveFiles {
        let _ = supervisor;
        DriveFiles::default()
    }
}

/// A session number that no earlier session on this machine had, up to chance.
#[must_use]
pub fn session_number() -> u32 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (now.as_nanos() as u32) ^ std::process::id().rotate_left(16)
}

/// An open link to a drive that has received nothing yet.
pub struct Opened {
    /// The link.
    pub link: Box<dyn Link>,
    /// What runs the drive.
    pub host: DriveHost,
}

/// A parsed name of a device, or what is missing in it.
pub type ParsedKind = Result<Box<dyn DeviceKind>, String>;

/// The kind in a name that begins with `prefix`; `None` for another name. `parse` parses the rest.
pub(super) fn after<K: DeviceKind + 'static>(
    prefix: &str,
    text: &str,
    parse: impl Fn(&str) -> Result<K, String>,
) -> Option<ParsedKind> {
    Some(match parse(text.strip_prefix(prefix)?) {
        Ok(kind) => Ok(Box::new(kind)),
        Err(problem) => Err(format!("{prefix} {problem}")),
    })
}

/// How a user names a kind of device.
#[derive(Clone, Copy)]
pub struct Syntax {
    /// What to write, for error messages.
    pub form: &'static str,
    /// Parses a name; `None` if it is of another kind.
    ///
    /// # Errors
    /// The name is of this kind and incomplete.
    pub parse: fn(&str) -> Option<ParsedKind>,
}
