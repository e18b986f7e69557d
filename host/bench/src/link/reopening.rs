//! A terminal that may go and come back: unplugged and plugged in again, or closed and opened by another drive.

use std::path::PathBuf;
use std::time::Instant;

use super::{Link, LinkError};

/// Opens a link by its path.
pub type Open = Box<dyn FnMut(&PathBuf) -> std::io::Result<Box<dyn Link>> + Send>;

/// A link that is opened again, by the name it was opened by, when its input is to be discarded and it is gone: that is
/// how a conversation begins. Until then a link that is gone stays gone, so nobody talks to another drive unawares.
pub struct Reopening {
    path: PathBuf,
    open: Open,
    link: Option<Box<dyn Link>>,
}

impl Reopening {
    /// Opens it for the first time.
    ///
    /// # Errors
    /// It can't be opened.
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
