//! The drive's scope: signals around an event, at the rate of its loop, read after the event.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Capabilities, Outcome};
use lashloop_protocol::message::{Capture, CaptureRows, ReadCapture};
use lashloop_protocol::wire::Payload;

use crate::capture_request::{CaptureRequest, CapturedRows};
use crate::client::Session;
use crate::error::SessionError;
use crate::refusal::Reply;

/// Why a capture is missing.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// The drive has no scope.
    #[error(
        "the drive captures no signals: its Identity lacks the capability CAPTURE; take a firmware that has it"
    )]
    Unsupported,
    /// The drive rejected the request.
    #[error("the drive answered {cause}")]
    Rejected {
        /// The drive's answer.
        outcome: Outcome,
        /// The same in words.
        cause: String,
    },
    /// The drive has no complete capture.
    #[error("{cause}")]
    NotCaptured {
        /// Why, in words.
        cause: String,
    },
    /// A message without whole rows, or more rows than have numbers.
    #[error(
        "the drive sent {values} values from row {first} on, and a row has {width}: correct the firmware's CaptureRows"
    )]
    Malformed {
        /// Values in the message.
        values: usize,
        /// Its first row.
        first: u16,
        /// Values of a row.
        width: usize,
    },
    /// The session failed.
    #[error(transparent)]
    Session(#[from] SessionError),
}

impl Session {
    /// Whether the drive captures signals.
    #[must_use]
    pub fn has_scope(&self) -> bool {
        self.identity.capabilities.contains(Capabilities::CAPTURE)
    }

    /// Makes the drive capture signals around the next event, instead of an earlier capture. A reset ends it.
    ///
    /// # Errors
    /// The drive has no scope, rejected the request or is silent, or the line broke.
    pub fn capture(&mut self, capture: CaptureRequest) -> Result<(), CaptureError> {
        if !self.has_scope() {
            return Err(CaptureError::Unsupported);
        }
        let CaptureRequest { every, before, trigger, trigger_signal, level, .. } = capture;
        let signals = capture.bits();
        let reply = self.result(Capture { signals, every, before, trigger, trigger_signal, level })?.with;
        match reply.outcome {
            Outcome::Accepted => {
                self.capture = Some(capture);
                Ok(())
            }
            outcome => Err(CaptureError::Rejected { outcome, cause: self.cause(reply) }),
        }
    }

    /// The capture that the drive has accepted since the last reset.
    #[must_use]
    pub fn accepted_capture(&self) -> Option<&CaptureRequest> {
        self.capture.as_ref()
    }

    /// Reads the rows of the capture that the drive has accepted.
    ///
    /// # Errors
    /// The capture is missing or incomplete, the drive rejected the request or is silent, or the line broke.
    pub fn read_capture(&mut self) -> Result<CapturedRows, CaptureError> {
        let (signals, every) = match &self.capture {
            Some(capture) => (capture.signals().to_vec(), capture.every),
            None => return Err(CaptureError::NotCaptured { cause: "no capture was requested".to_owned() }),
        };
        let width = signals.len().max(1);
        let (mut rows, mut event) = (Vec::new(), 0);
        loop {
            let first = rows.len() as u16;
            let answer = self.line.request(&ReadCapture { first }.into(), |message| match message {
                DriveMessage::CaptureRows(it) if it.first == first => Some(Ok(*it)),
                DriveMessage::CommandResult(it) if it.request == ReadCapture::LAYOUT.kind => {
                    Some(Err(Reply::from(it)))
                }
                _ => None,
            })?;
            match answer.with {
                Ok(CaptureRows { event: at, values, .. }) => {
                    let values = values.as_slice();
                    if values.len() % width != 0 || rows.len() + values.len() / width > u16::MAX.into() {
                        return Err(CaptureError::Malformed { values: values.len(), first, width });
                    }
                    event = at;
                    rows.extend(values.chunks(width).map(<[f32]>::to_vec));
                }
                Err(Reply { outcome: Outcome::UnknownIndex, .. }) => {
                    return Ok(CapturedRows { signals, every, event, rows });
                }
                Err(reply) if reply.outcome == Outcome::NotCaptured => {
                    return Err(CaptureError::NotCaptured { cause: self.cause(reply) });
                }
                Err(reply) => {
                    return Err(CaptureError::Rejected { outcome: reply.outcome, cause: self.cause(reply) });
                }
            }
        }
    }

    fn cause(&mut self, reply: Reply) -> String {
        self.line.cause_of(reply, &self.parameters, &self.signals)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use lashloop_firmware::Laws;
    use lashloop_link::in_process::InProcess;
    use lashloop_protocol::EncoderCounts;
    use lashloop_protocol::enums::CaptureTrigger;
    use lashloop_protocol::message::EncoderSample;

    use super::*;

    fn session() -> Session {
        Session::open(Box::new(InProcess::<Laws>::default()), 1).expect("a drive")
    }

    fn request(session: &Session, names: &[&str]) -> CaptureRequest {
        let signals = names.iter().map(|name| session.signal(name).expect("a signal").clone());
        CaptureRequest::new(signals.collect())
    }

    fn steps(session: &mut Session, count: u32) {
        session.start().expect("a drive that starts");
        for step in 0..count {
            let [motor_counts, load_counts] = [i64::from(step), 0].map(EncoderCounts::wrapping);
            let sample = EncoderSample { sequence: 0, motor_counts, load_counts, reference_rad: 0.0 };
            let deadline = session.line.now() + Duration::from_secs(5);
            session.exchange(step, &sample, deadline).expect("a torque");
        }
        session.stop().expect("a stop");
    }

    #[test]
    fn all_rows_of_a_capture_are_read_with_their_event() {
        let mut session = session();
        let mut capture = request(&session, &["measured_twist_rad", "requested_torque_nm"]);
        let names: Vec<_> = capture.signals().iter().map(|it| &*it.signal.name).collect();
        assert_eq!(names, ["requested_torque_nm", "measured_twist_rad"], "in the order of the values");
        capture.before = 5;
        session.capture(capture).expect("a capture");
        steps(&mut session, 20);
        let captured = session.read_capture().expect("rows");
        assert_eq!((captured.event, captured.rows.len()), (5, 20));
        let count_rad = std::f32::consts::TAU / 131_072.0;
        for pair in captured.rows.windows(2) {
            let moved_rad = pair[1][1] - pair[0][1];
            assert!((moved_rad - count_rad).abs() < 1e-6, "a count a step: {pair:?}");
        }
    }

    #[test]
    fn a_capture_without_its_event_is_an_error_that_says_so() {
        let mut session = session();
        let mut capture = request(&session, &["measured_twist_rad"]);
        (capture.trigger, capture.level) = (CaptureTrigger::Rising, 1.0);
        session.capture(capture).expect("a capture");
        steps(&mut session, 20);
        let error = session.read_capture().expect_err("no event").to_string();
        assert_eq!(error, "NotCaptured: the event did not come");
    }

    #[test]
    fn a_refused_capture_is_an_error_with_the_outcome() {
        let mut session = session();
        let mut capture = request(&session, &["measured_twist_rad"]);
        capture.before = 2000;
        let error = session.capture(capture).expect_err("too many rows");
        assert!(matches!(error, CaptureError::Rejected { outcome: Outcome::OutOfRange, .. }), "{error}");
    }

    #[test]
    fn a_drive_without_the_capability_is_asked_for_nothing() {
        let mut session = session();
        let capture = request(&session, &["measured_twist_rad"]);
        session.identity.capabilities.remove(Capabilities::CAPTURE);
        let sent = session.traffic().frames_sent;
        assert!(matches!(session.capture(capture), Err(CaptureError::Unsupported)));
        assert_eq!(session.traffic().frames_sent, sent);
    }
}
