//! A link that is opened again after it was disconnected: a board unplugged and plugged in, a terminal closed and opened by
//! a drive, a TCP connection that a server closed.

use std::time::Instant;

use super::{Link, LinkError};

type Open = Box<dyn FnMut() -> Result<Box<dyn Link>, LinkError> + Send>;

/// A link that is opened again, by the same name, when it is disconnected and its input is to be discarded: every session
/// begins with that. Until then it stays disconnected, so that no request reaches another drive unnoticed.
pub struct Reopening {
    open: Open,
    link: Option<Box<dyn Link>>,
}

impl Reopening {
    /// Opens the link for the first time. Later failures of `open` leave the link disconnected.
    ///
    /// # Errors
    /// `open` fails.
    pub fn new<E: 'static>(
        open: impl FnMut() -> Result<Box<dyn Link>, E> + Send + 'static,
    ) -> Result<Self, E> {
        Self::explaining(open, |_| LinkError::Disconnected)
    }

    /// As [`Self::new`], with the error that a later failure of `open` is for the session.
    ///
    /// # Errors
    /// `open` fails.
    pub fn explaining<E: 'static>(
        mut open: impl FnMut() -> Result<Box<dyn Link>, E> + Send + 'static,
        explain: fn(E) -> LinkError,
    ) -> Result<Self, E> {
        let link = Some(open()?);
        Ok(Self { open: Box::new(move || open().map_err(explain)), link })
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
            self.link = Some((self.open)()?);
        }
        self.with(|link| link.discard_input())
    }
}
