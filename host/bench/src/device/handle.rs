//! A drive with an open session.

use lashloop_link::Link;

use super::choice::DeviceChoice;
use super::connection::{Connection, LineSpeed};
use super::error::DeviceError;
use super::evidence::Evidence;
use crate::supervisor::Supervisor;
use lashloop_session::{Session, SessionError};

/// A drive with an open session. Dropping it ends the process behind the drive, if the bench started one.
pub struct Device {
    /// The session.
    pub session: Session,
    /// What is behind the link.
    pub connection: Connection,
}

impl Device {
    /// Starts what has to be started, opens the link and shakes hands.
    ///
    /// # Errors
    /// What could not be reached, and what to do.
    pub fn open(
        choice: &DeviceChoice,
        speed: impl Into<LineSpeed>,
        supervisor: &Supervisor,
    ) -> Result<Self, DeviceError> {
        Self::open_through(choice, speed, supervisor, |link| link)
    }

    /// As [`Self::open`], with a middleware around the link from its first byte on.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_through(
        choice: &DeviceChoice,
        speed: impl Into<LineSpeed>,
        supervisor: &Supervisor,
        middleware: impl FnOnce(Box<dyn Link>) -> Box<dyn Link>,
    ) -> Result<Self, DeviceError> {
        let (link, connection) = Connection::open(choice, speed, supervisor)?;
        let session = Session::open(middleware(link), choice.session_number())
            .map_err(|source| connection.explain(source))?;
        Ok(Self { session, connection })
    }

    /// The device as one line of text for the record, see [`Connection::description`].
    #[must_use]
    pub fn description(&self) -> String {
        self.connection.description(&self.session.identity)
    }

    /// What casts doubt on a run, each in a sentence: an image or twin that is older than its sources, or of another build
    /// than the bench; an adapter that holds received bytes for long; [`Session::oddities`] of the drive.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.connection.files.warnings(&self.session.identity);
        warnings.extend(self.connection.long_latency_timer());
        warnings.extend(self.session.oddities());
        warnings
    }

    /// The drive's origin for the record, with what casts doubt on it. Reads and hashes the files that run as the drive.
    #[must_use]
    pub fn evidence(&self) -> Evidence {
        let mut evidence = self.connection.files.evidence(&self.session.identity);
        evidence.warnings.extend(self.session.oddities());
        evidence
    }

    /// An error of the session as an error of this device, see [`Connection::explain`].
    #[must_use]
    pub fn explain(&self, source: SessionError) -> DeviceError {
        self.connection.explain(source)
    }

    /// The error for a drive that keeps to the protocol but does not fit this bench.
    #[must_use]
    pub fn unfit(&self, problem: String) -> DeviceError {
        DeviceError::Unfit { device: self.connection.choice.to_string(), problem }
    }
}
