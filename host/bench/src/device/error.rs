//! Why there is no drive to talk to, or no longer one.

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;

use lashloop_protocol::enums::State;

use crate::session::SessionError;
use crate::supervisor::Process;

/// A device that can't be reached or was lost. Each says which side, and what to do where something can be done.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    /// The terminal can't be opened.
    #[error("{}: {}", path.display(), open_reason(source))]
    Open {
        /// Its path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A wire is to be modelled on a line that has a real one.
    #[error(
        "{}: a serial port has a wire of its own, at link.baud = {baud}; link.modelled_baud is for drives without one, so leave it 0 here",
        path.display()
    )]
    HasWire {
        /// Its path.
        path: PathBuf,
        /// Its speed.
        baud: u32,
    },
    /// There is no image to run.
    #[error("no image of the firmware at {}: build it with `cargo xtask image`", path.display())]
    NoImage {
        /// Where it was looked for.
        path: PathBuf,
    },
    /// There is no emulator.
    #[error(
        "qemu-system-arm is not installed: `cargo xtask setup` installs it, or on Debian `apt-get install qemu-system-arm`"
    )]
    NoEmulator,
    /// A program can't be started.
    #[error("the {name} can't be started: {source}; is the machine out of processes, memory or terminals?")]
    Spawn {
        /// What it is.
        name: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// A program was started and did not come up.
    #[error(
        "the {name} did not come up{}; for the emulator `cargo xtask image` builds an image it can boot",
        tail(said)
    )]
    NotUp {
        /// What it is.
        name: &'static str,
        /// What it wrote to standard error.
        said: String,
    },
    /// The process behind the drive ended.
    #[error(
        "the drive side ended while the bench was talking to {device}: the {name} (process {id}), {status}{}: {source}",
        tail(said)
    )]
    Ended {
        /// The device as it was chosen.
        device: String,
        /// What ended.
        name: &'static str,
        /// Its process number.
        id: u32,
        /// How.
        status: ExitStatus,
        /// What it wrote to standard error.
        said: String,
        /// How far the conversation had got.
        source: Box<SessionError>,
    },
    /// The drive keeps to the protocol but can't serve this bench.
    #[error("drive on {device}: {problem}; the firmware does not fit this bench")]
    Unfit {
        /// The device as it was chosen.
        device: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The conversation broke or was refused.
    #[error("drive on {device}: {source}{}", remedy(source))]
    Session {
        /// The device as it was chosen.
        device: String,
        /// What happened.
        source: SessionError,
    },
}

impl DeviceError {
    /// Whether a drive that is gone may still come back: what has ended does not, and another firmware stays another.
    #[must_use]
    pub fn may_pass(&self) -> bool {
        match self {
            Self::Session { source, .. } => !matches!(source, SessionError::Version { .. }),
            _ => false,
        }
    }

    pub(super) fn not_up(process: &Process) -> Self {
        // Whatever it has to say, it has said when it has ended.
        let _ = process.ended_within(std::time::Duration::from_millis(200));
        Self::NotUp { name: process.name(), said: process.said() }
    }
}

fn tail(said: &str) -> String {
    if said.is_empty() { String::new() } else { format!(", saying \"{said}\"") }
}

fn open_reason(source: &io::Error) -> String {
    match source.kind() {
        io::ErrorKind::NotFound => "there is no such terminal; is the drive plugged in?".to_owned(),
        io::ErrorKind::PermissionDenied => {
            "not allowed; on most systems the group `dialout` may open serial ports".to_owned()
        }
        io::ErrorKind::WouldBlock | io::ErrorKind::ResourceBusy => {
            "another program holds it; a drive talks to one host at a time".to_owned()
        }
        // ENOTTY, of which the serialport crate keeps only the words.
        _ if source.raw_os_error() == Some(25) || source.to_string() == "Not a typewriter" => {
            "this is no terminal; a drive sits on one".to_owned()
        }
        _ => source.to_string(),
    }
}

fn remedy(source: &SessionError) -> &'static str {
    match source {
        SessionError::Broken { .. } => "; check the cable and the power of the drive, then start again",
        SessionError::Silent { last_seen, .. } if last_seen.frame.is_none() => {
            "; is it a Lashloop drive, powered, at this baud rate?"
        }
        SessionError::TooLongAGap { .. } => "; the bench slept, the firmware hangs or the line is cut",
        SessionError::Silent { .. } => "; the firmware hangs or the line is cut",
        SessionError::Refused { state: State::Boot, .. } => {
            "; it has restarted: look at its power and its reset line"
        }
        SessionError::Version { .. } | SessionError::Refused { .. } => "",
    }
}
