//! A request and its answer, over a line that may lose either.

use std::time::Duration;

use lashloop_protocol::{DriveMessage, HostMessage, Message};

use crate::error::SessionError;
use crate::handshake::shake_hands;
use crate::line::Line;

/// Time for all attempts at a request. A drive answers at once; the rest is for a line that loses frames and for an
/// emulator on a busy machine.
pub const REQUEST_LIMIT: Duration = Duration::from_secs(2);
/// Attempts at a request. They are counted, not timed: a bench that stood still has not waited for the drive.
const ATTEMPTS: u32 = 4;
/// Time for an attempt. After it the request is retransmitted, because the request or its answer may be lost.
const ATTEMPT_LIMIT: Duration = REQUEST_LIMIT.checked_div(ATTEMPTS).expect("an attempt");

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
    /// No answer within [`REQUEST_LIMIT`], the time of all attempts, or what is left of [`PATIENCE`](crate::PATIENCE), or the line broke.
    pub fn request<T>(
        &mut self,
        request: &HostMessage,
        mut wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Answered<T>, SessionError> {
        for attempt in 0..ATTEMPTS {
            let repeated = attempt > 0;
            if repeated {
                tracing::debug!(request = request.layout().name, attempt, "no answer in time: sent again");
            }
            if let Some(with) = self.attempt(request, ATTEMPT_LIMIT, &mut wanted)? {
                if repeated {
                    // Until the answers to earlier copies have arrived, one could be taken for the answer to a later
                    // request of its kind. Answers keep their order: none is left after a handshake.
                    shake_hands(self, self.session)?;
                }
                return Ok(Answered { with, repeated });
            }
            if self.patience.is_exhausted() {
                break;
            }
        }
        Err(self.silent(request.layout().name, REQUEST_LIMIT))
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
        let limit = self.patience.within(limit);
        let answer = self.wait(sent + limit, wanted)?;
        let waited = self.now().saturating_duration_since(sent);
        self.patience.spend(waited.min(limit));
        if answer.is_none() {
            // Part of a damaged frame in the drive's decoder must not swallow the next frame.
            self.end_frame()?;
        }
        Ok(answer)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use lashloop_firmware::Laws;
    use lashloop_link::in_process::InProcess;
    use lashloop_link::{Link, LinkError};
    use lashloop_protocol::message::{GetParameter, ParameterReport};

    use super::*;

    /// A drive whose bench stands still in its next waits: each ends 20 s late and empty.
    struct StandsStill {
        drive: InProcess<Laws>,
        times: u32,
    }

    impl Link for StandsStill {
        fn inner(&mut self) -> Option<&mut dyn Link> {
            Some(&mut self.drive)
        }

        fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
            self.drive.send(bytes)
        }

        fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
            if self.times == 0 {
                return self.drive.receive(buffer, deadline);
            }
            self.times -= 1;
            self.drive.wait_until(deadline + Duration::from_secs(20))?;
            self.drive.discard_input()?;
            Ok(0)
        }

        fn discard_input(&mut self) -> Result<(), LinkError> {
            self.drive.discard_input()
        }
    }

    fn read_parameter(times: u32) -> Result<Answered<ParameterReport>, SessionError> {
        let mut line = Line::new(Box::new(StandsStill { drive: InProcess::default(), times }));
        line.request(&GetParameter { index: 0 }.into(), |message| match message {
            DriveMessage::ParameterReport(report) => Some(*report),
            _ => None,
        })
    }

    #[test]
    fn a_bench_that_stood_still_asks_again() {
        for times in 0..ATTEMPTS {
            let answered = read_parameter(times).expect("an answer");
            assert_eq!(answered.with.index, 0, "{times} late waits");
        }
    }

    #[test]
    fn a_drive_that_answers_no_attempt_is_silent() {
        let answer = read_parameter(ATTEMPTS);
        assert!(matches!(answer, Err(SessionError::Silent { .. })), "{:?}", answer.err());
    }

    #[test]
    fn a_handshake_goes_on_after_the_bench_stood_still() {
        let mut line = Line::new(Box::new(StandsStill { drive: InProcess::default(), times: 3 }));
        assert_eq!(shake_hands(&mut line, 1).expect("an identity").session, 1);
    }
}
