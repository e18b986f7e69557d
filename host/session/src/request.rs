//! A request and its answer, over a line that may lose either.

use std::time::Duration;

use lashloop_protocol::{DriveMessage, HostMessage, Message, Numbered};

use crate::error::SessionError;
use crate::line::Line;

/// Time for all attempts at a request. A drive answers at once; the rest is for a line that loses frames and for an
/// emulator on a busy machine.
pub const REQUEST_LIMIT: Duration = Duration::from_secs(2);
/// Attempts at a request. They are counted, not timed: a bench that stood still has not waited for the drive.
const ATTEMPTS: u32 = 4;
/// Time for an attempt. After it the request is retransmitted, because the request or its answer may be lost.
pub(crate) const ATTEMPT_LIMIT: Duration = REQUEST_LIMIT.checked_div(ATTEMPTS).expect("an attempt");

/// The answer to a request.
pub struct Answered<T> {
    /// The answer.
    pub with: T,
    /// The request was retransmitted, so an earlier copy may have taken effect before this answer.
    pub repeated: bool,
}

impl Line {
    /// Sends a request, again after a timeout, and waits for the answer that `wanted` recognises. All copies have one number.
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
        let numbered = Numbered { number: self.next_number(), message: *request };
        for attempt in 0..ATTEMPTS {
            let repeated = attempt > 0;
            if repeated {
                tracing::debug!(request = request.layout().name, attempt, "no answer in time: sent again");
            }
            if let Some(with) = self.attempt_numbered(&numbered, ATTEMPT_LIMIT, &mut wanted)? {
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
        let numbered = Numbered { number: self.next_number(), message: *request };
        self.attempt_numbered(&numbered, limit, wanted)
    }

    fn attempt_numbered<T>(
        &mut self,
        request: &Numbered<HostMessage>,
        limit: Duration,
        wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, SessionError> {
        self.send_numbered(request)?;
        let sent = self.now();
        let limit = self.patience.within(limit);
        let answer = self.answer(request.number, sent + limit, wanted)?;
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
    use crate::handshake::shake_hands;

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

    /// A drive whose first answer arrives with the third.
    struct Late {
        drive: InProcess<Laws>,
        waits: u32,
        late: Vec<u8>,
    }

    impl Link for Late {
        fn inner(&mut self) -> Option<&mut dyn Link> {
            Some(&mut self.drive)
        }

        fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
            self.drive.send(bytes)
        }

        fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
            self.waits += 1;
            let count = self.drive.receive(buffer, deadline)?;
            match self.waits {
                1 => {
                    self.late = buffer[..count].to_vec();
                    self.drive.wait_until(deadline)?;
                    Ok(0)
                }
                3 => {
                    let both = [&self.late, &buffer[..count]].concat();
                    buffer[..both.len()].copy_from_slice(&both);
                    Ok(both.len())
                }
                _ => Ok(count),
            }
        }

        fn discard_input(&mut self) -> Result<(), LinkError> {
            self.drive.discard_input()
        }
    }

    #[test]
    fn a_late_answer_to_a_retry_is_not_taken_for_the_next() {
        let drive = InProcess::default();
        let mut line = Line::new(Box::new(Late { drive, waits: 0, late: Vec::new() }));
        let mut read = |index| {
            let answered = line.request(&GetParameter { index }.into(), |message| match message {
                DriveMessage::ParameterReport(report) => Some(report.index),
                _ => None,
            });
            let Answered { with, repeated } = answered.expect("an answer");
            (with, repeated)
        };
        assert_eq!([read(0), read(1), read(2)], [(0, true), (1, false), (2, false)]);
    }

    #[test]
    fn requests_are_numbered_1_to_255_in_turn() {
        let mut line = Line::new(Box::new(InProcess::<Laws>::default()));
        let numbers: Vec<_> = (0..257).map(|_| line.next_number()).collect();
        assert_eq!((numbers[0], &numbers[253..]), (1, &[254, 255, 1, 2][..]));
    }

    #[test]
    fn a_handshake_goes_on_after_the_bench_stood_still() {
        let mut line = Line::new(Box::new(StandsStill { drive: InProcess::default(), times: 3 }));
        assert_eq!(shake_hands(&mut line, 1).expect("an identity").session, 1);
    }
}
