//! Errors of a connection to a drive.

use std::fmt;
use std::io;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;

use lashloop_protocol::enums::State;

use lashloop_session::SessionError;
use rustix::process::Signal;

/// Why a drive can't be reached or was lost: which side failed, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    /// The device can't be reached as it is named, or not at this speed.
    #[error("{device}: {problem}")]
    Unreachable {
        /// The device, as given to `--device`; of a native twin the path of its terminal.
        device: String,
        /// Why, and what to do.
        problem: String,
    },
    /// A program or an image is missing: where it was looked for, and what to do.
    #[error("{0}")]
    Missing(String),
    /// A program can't be started.
    #[error("the {name} can't be started: {source}; is the machine out of processes, memory or terminals?")]
    Spawn {
        /// The program's part, as in "the emulator can't be started".
        name: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A program was started and did not come up in time.
    #[error(
        "the {name} did not come up{}; for the emulator `cargo xtask image` builds an image it can boot",
        quoted(stderr)
    )]
    NotUp {
        /// The program's part, as in "the emulator did not come up".
        name: &'static str,
        /// The first lines of its standard error.
        stderr: String,
    },
    /// The process behind the drive ended.
    #[error(
        "the drive side ended during the session with {device}: the {name} (process {id}), {status}{}: {source}",
        quoted(stderr)
    )]
    Ended {
        /// The device, as given to `--device`.
        device: String,
        /// The program's part, as in "the emulator".
        name: &'static str,
        /// Process id.
        id: u32,
        /// Exit code or signal.
        status: ExitStatus,
        /// The lines of its standard error that matter most.
        stderr: String,
        /// Error of the session at the end of the process.
        source: Box<SessionError>,
    },
    /// A plant behind the pins needs the scale of the amplifier.
    #[error(
        "{device} has the scenario's plant behind its pins, and an amplifier without a scale: set bench.torque_per_duty_nm"
    )]
    NoScale {
        /// The device.
        device: String,
    },
    /// The load of a bench is not at the start of the scenario.
    #[error(
        "drive on {device}: its load is {distance_rad:.4} rad away from where the drive was powered up, and the scenario starts \
         there, within {tolerance_rad} rad: bring the load to its start and power the drive off and on"
    )]
    AwayFromStart {
        /// The device.
        device: String,
        /// Distance of the load from its start, in rad.
        distance_rad: f64,
        /// Largest distance allowed, in either direction.
        tolerance_rad: f64,
    },
    /// The drive keeps to the protocol but can't serve this bench.
    #[error("drive on {device}: {problem}; the firmware does not fit this bench")]
    Unfit {
        /// The device, as given to `--device`.
        device: String,
        /// The violation as a clause, as in "it sent a torque of inf N m".
        problem: String,
    },
    /// The session failed.
    #[error("drive on {device}: {source}{}{}", remedy(source), quoted(stderr))]
    Session {
        /// The device, as given to `--device`.
        device: String,
        /// The lines that its process has printed; empty for a drive without one.
        stderr: String,
        /// Error of the session.
        source: Box<SessionError>,
    },
}

/// The part of the user's own program in messages.
pub(super) const COMMAND: &str = "command";
/// Signals that a program's own faults cause.
const CRASHES: [Signal; 5] = [Signal::ILL, Signal::ABORT, Signal::BUS, Signal::FPE, Signal::SEGV];

impl DeviceError {
    pub(super) fn unreachable(device: impl fmt::Display, problem: impl fmt::Display) -> Self {
        Self::Unreachable { device: device.to_string(), problem: problem.to_string() }
    }

    /// A terminal can't be opened.
    pub(super) fn not_opened(path: &Path, error: &io::Error) -> Self {
        Self::unreachable(path.display(), open_reason(error))
    }

    /// A UART is to be modelled on a serial port of this speed, in bit/s.
    pub(super) fn has_uart(device: String, baud: u32) -> Self {
        let problem = format!(
            "a serial port has a UART of its own, at link.baud = {baud}; link.modelled_baud is for drives without one, so \
             leave it 0 here"
        );
        Self::Unreachable { device, problem }
    }

    /// Whether the user's own program behind the drive has ended by itself, rather than by a signal from outside. A program that has
    /// sent no good frame and says that it succeeded may be anything, such as `cat`. One that only stayed silent has ended since, for
    /// example because the bench closed its terminal.
    #[must_use]
    pub fn has_crashed(&self) -> bool {
        let Self::Ended { name: COMMAND, status, source, .. } = self else { return false };
        let is_no_drive = match &**source {
            SessionError::Broken { last_seen, .. } => last_seen.frame.is_none() && status.success(),
            SessionError::Silent { last_seen, .. } => last_seen.frame.is_none(),
            _ => false,
        };
        if is_no_drive {
            return false;
        }
        let signal = status.signal().and_then(Signal::from_named_raw);
        status.code().is_some() || signal.is_some_and(|signal| CRASHES.contains(&signal))
    }

    /// Whether a lost drive may still come back. A process that ended does not, and another firmware stays another.
    #[must_use]
    pub fn is_transient(&self) -> bool {
        match self {
            Self::Session { source, .. } => !matches!(
                **source,
                SessionError::Version { .. } | SessionError::Count { .. } | SessionError::Choices { .. }
            ),
            _ => false,
        }
    }
}

pub(super) fn listed(places: &[PathBuf]) -> String {
    places.iter().map(|place| place.display().to_string()).collect::<Vec<_>>().join(", ")
}

fn quoted(stderr: &str) -> String {
    if stderr.is_empty() { String::new() } else { format!(", standard error \"{stderr}\"") }
}

fn open_reason(source: &io::Error) -> String {
    match source.kind() {
        io::ErrorKind::NotFound => "there is no such terminal; is the drive plugged in?".to_owned(),
        io::ErrorKind::PermissionDenied => {
            "not allowed; on most systems the group `dialout` may open serial ports".to_owned()
        }
        io::ErrorKind::WouldBlock | io::ErrorKind::ResourceBusy => {
            "another program holds it; a drive serves one host at a time".to_owned()
        }
        // ENOTTY, of which the serialport crate keeps only the text.
        _ if source.raw_os_error() == Some(25) || source.to_string() == "Not a typewriter" => {
            "this isn't a terminal, and a drive needs one".to_owned()
        }
        _ => source.to_string(),
    }
}

fn remedy(source: &SessionError) -> &'static str {
    match source {
        SessionError::Broken { diagnosis: None, .. } => {
            "; check the cable and the power of the drive, then start again"
        }
        SessionError::TooLongAGap { .. } => "; the bench slept, the firmware hangs or the line is cut",
        SessionError::Refused { state: State::Boot, .. } => {
            "; it has restarted: look at its power and its reset line"
        }
        // A diagnosis has the remedy.
        SessionError::Silent { .. }
        | SessionError::Slow { .. }
        | SessionError::SlowTorques { .. }
        | SessionError::Broken { diagnosis: Some(_), .. }
        | SessionError::Version { .. }
        | SessionError::Refused { .. }
        | SessionError::Count { .. }
        | SessionError::Choices { .. } => "",
    }
}
