//! A request and its answer, over a line that may lose either.

use std::time::Duration;

use lashloop_protocol::{DriveMessage, HostMessage, Message};

use crate::error::SessionError;
use crate::handshake::shake_hands;
use crate::line::Line;

/// Time for all attempts at a request. A drive answers at once; the rest is for a line that loses frames and for an
/// emulator on a busy machine.
pub const REQUEST_LIMIT: Duration = Duration::from_secs(2);
/// Time for an attempt. After it the request is retransmitted, because the request or its answer may be lost.
const ATTEMPT_LIMIT: Duration = Duration::from_millis(500);

/// The answer to a request.
pub struct Answered<T> {
    /// The answer.
    pub with: T,
    /// The request was retransmitted, so an earlier copy may have taken effect before this answer.
    pub repeated: bool,
}

impl Line {
    /// Sends a request, again after a timeout, and waits for the answer that `wanted` recognises.
    ///
    /// The request must be repeatable: the drive executes every copy that reaches it.
    ///
    /// # Errors
    /// No answer within [`REQUEST_LIMIT`] or what is left of [`PATIENCE`](crate::PATIENCE), or the line broke.
    pub fn request<T>(
        &mut self,
        request: &HostMessage,
        mut wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Answered<T>, SessionError> {
        let give_up = self.now() + REQUEST_LIMIT;
        let mut repeated = false;
        loop {
            if let Some(with) = self.attempt(request, ATTEMPT_LIMIT, &mut wanted)? {
                if repeated {
                    // Until the answers to earlier copies have arrived, one could be taken for the answer to a later
                    // request of its kind. Answers keep their order: none is left after a handshake.
                    shake_hands(self, self.session)?;
                }
                return Ok(Answered { with, repeated });
            }
            if self.now() >= give_up || self.patience.is_exhausted() {
                return Err(self.silent(request.layout().name, REQUEST_LIMIT));
            }
            repeated = true;
        }
    }

    /// Sends a request once and waits for its answer, `limit` at most.
    ///
    /// # Errors
    /// The line broke.
    pub fn attempt<T>(
        &mut self,
        request: &HostMessage,
        limit: Duration,
        wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, SessionError> {
        self.send(request)?;
        let sent = self.now();
        let answer = self.wait(sent + self.patience.within(limit), wanted)?;
        let waited = self.now().saturating_duration_since(sent);
        self.patience.spend(waited);
        if answer.is_none() {
            // Part of a damaged frame in the drive's decoder must not swallow the next frame.
            self.end_frame()?;
        }
        Ok(answer)
    }
}
