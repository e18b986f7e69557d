//! What is behind a link.

use std::time::Duration;

use lashloop_link::latency_timer::LatencyTimer;
use lashloop_link::uart_model::UartModel;
use lashloop_link::{Link, LinkError};
use lashloop_protocol::message::Identity;

use super::choice::DeviceChoice;
use super::drive_host::DriveHost;
use super::error::DeviceError;
use super::evidence::{Build, OpenFiles};
use super::kind::Opened;
use super::own_time::OwnTime;
use crate::scenario::sections::LinkSettings;
use crate::supervisor::{Process, Supervisor};
use lashloop_session::{SessionError, printable};

/// A line that closes is often the first sign of a process that ends; the end itself follows within this time.
const END_LIMIT: Duration = Duration::from_millis(500);

/// The speed of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineSpeed {
    /// Bits per second of a serial port; any other line ignores it.
    pub baud: u32,
    /// Bits per second of a UART to be modelled on a line without one; `None` for no model.
    pub modelled_baud: Option<u32>,
}

impl From<u32> for LineSpeed {
    /// `baud` bits per second, without a modelled UART.
    fn from(baud: u32) -> Self {
        Self { baud, modelled_baud: None }
    }
}

impl From<&LinkSettings> for LineSpeed {
    fn from(link: &LinkSettings) -> Self {
        Self { baud: link.baud, modelled_baud: link.modelled_baud() }
    }
}

/// What is behind a link: the drive that was chosen and what runs it.
pub struct Connection {
    /// The drive that was chosen.
    pub choice: DeviceChoice,
    /// What runs the drive.
    pub host: DriveHost,
    modelled_baud: Option<u32>,
    pub(super) files: OpenFiles,
}

impl Connection {
    /// Starts what has to be started and opens the link. Nothing is sent to the drive.
    ///
    /// # Errors
    /// What can't be started or opened, and what to do; or a UART is to be modelled on a line that has one.
    pub fn open(
        choice: &DeviceChoice,
        speed: impl Into<LineSpeed>,
        supervisor: &Supervisor,
    ) -> Result<(Box<dyn Link>, Self), DeviceError> {
        let LineSpeed { baud, modelled_baud } = speed.into();
        if modelled_baud.is_some() {
            choice.check_modelled_uart(baud)?;
        }
        let Opened { link, host } = choice.open(baud, supervisor)?;
        tracing::debug!(device = %choice, baud, modelled_baud, "the line is open");
        let files = OpenFiles::open(choice.files(supervisor));
        let link: Box<dyn Link> = match host.process() {
            Some(process) => Box::new(OwnTime::new(link, process.watch.clone())),
            None => link,
        };
        let link = match modelled_baud {
            Some(baud) => Box::new(UartModel::new(link, baud)),
            None => link,
        };
        Ok((link, Self { choice: choice.clone(), host, modelled_baud, files }))
    }

    /// The choice, the drive's identity and the modelled UART as one line of text.
    #[must_use]
    pub fn description(&self, identity: &Identity) -> String {
        let uart =
            self.modelled_baud.map_or_else(String::new, |baud| format!(", wire modelled at {baud} Bd"));
        format!(
            "{} ({}, firmware {}, {}){uart}",
            self.choice,
            printable(identity.board.as_str()),
            identity.firmware,
            Build::of(identity)
        )
    }

    /// The remedy for an adapter whose latency timer stays long, in a sentence. A reconnect brings its default back.
    #[must_use]
    pub fn long_latency_timer(&self) -> Option<String> {
        let remedy = LatencyTimer::shorten(self.choice.terminal()?).remedy()?;
        Some(format!("the latency timer of {} is {remedy}", self.choice))
    }

    /// An error of the session as an error of this device: with its name, and with the end of its process.
    #[must_use]
    pub fn explain(&self, source: SessionError) -> DeviceError {
        let patience = match source {
            SessionError::Broken { source: LinkError::Disconnected, .. } => Some(END_LIMIT),
            // The timeout of a silent drive was long enough.
            SessionError::Silent { .. }
            | SessionError::Slow { .. }
            | SessionError::SlowTorques { .. }
            | SessionError::TooLongAGap { .. } => Some(Duration::ZERO),
            _ => None,
        };
        let ended =
            self.host.process().zip(patience).and_then(|(process, patience)| {
                process.ended_within(patience).map(|status| (process, status))
            });
        let device = self.choice.to_string();
        match ended {
            Some((process, status)) => DeviceError::Ended {
                device,
                name: process.name,
                id: process.id,
                status,
                stderr: process.stderr(),
                source: Box::new(source),
            },
            None => {
                let stderr = self.host.process().map(Process::stderr).unwrap_or_default();
                DeviceError::Session { device, stderr, source: Box::new(source) }
            }
        }
    }
}
