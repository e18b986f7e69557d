//! A terminal that is opened again after it was disconnected: unplugged and plugged in, or closed and opened by a drive.

use std::path::PathBuf;
use std::time::Instant;

use super::{Link, LinkError};

/// Opens the link at a path.
pub type Open = Box<dyn FnMut(&PathBuf) -> std::io::Result<Box<dyn Link>> + Send>;

/// A link that is opened again, by the same path, when it is disconnected and its input is to be discarded: every session
/// begins with that. Until then it stays disconnected, so that no request reaches another drive unnoticed.
pub struct Reopening {
    path: PathBuf,
    open: Open,
    link: Option<Box<dyn Link>>,
}

impl Reopening {
    /// Opens the link for the first time.
    ///
    /// # Errors
    /// `open` fails.
    pub fn new(path: PathBuf, mut open: Open) -> std::io::Result<Self> {
        let link = Some(open(&path)?);
        Ok(Self { path, open, link })
    }

    fn with<T>(&mut self, act: impl FnOnce(&mut dyn Link) -> Result<T, LinkError>) -> Result<T, LinkError> {
        let link = self.link.as_mut().ok_or(LinkError::Disconnected)?;
        let result = act(link.as_mut());
        if matches!(result, Err(LinkError::Disconnected)) {
            self.link = None;
        }
        result
    }
}

impl Link for Reopening {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        self.link.as_deref_mut().map(|link| link as &mut dyn Link)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.with(|link| link.send(bytes))
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        self.with(|link| link.receive(buffer, deadline))
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        if self.link.is_none() {
            self.link = (self.open)(&self.path).ok();
        }
        self.with(|link| link.discard_input())
    }
}
