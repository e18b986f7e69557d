//! Several requests in one write, with their answers.

use super::assertion::{Failure, RuleResult, broken};
use super::client::Client;
use super::words::Words;
use super::writes::MOST_REQUESTS;
use crate::prelude::wire::*;

/// Requests in one write, without the marker after them.
pub(super) const BURST: usize = MOST_REQUESTS - 1;

/// A request and its only answer.
pub(super) type Exchange = (HostMessage, DriveMessage);

impl Client {
    /// Sends requests in one write and returns all of their answers but `Log`.
    pub(super) fn burst(&mut self, requests: &[HostMessage]) -> Result<Vec<DriveMessage>, Failure> {
        let mut bytes = Vec::new();
        for request in requests {
            bytes.extend_from_slice(&self.frame(*request));
        }
        self.request_bytes(&bytes)
    }

    /// Sends requests, a few in one write, and requires exactly these answers.
    pub(super) fn exchange(&mut self, when: &str, exchanges: &[Exchange]) -> RuleResult {
        for part in exchanges.chunks(BURST) {
            let requests: Vec<_> = part.iter().map(|(request, _)| *request).collect();
            let got = self.burst(&requests)?;
            for (place, (request, expected)) in part.iter().enumerate() {
                let came = got.get(place);
                // Equal numbers may differ in bits: -0 is not +0.
                if came.map(Message::frame).as_deref() != Some(&*expected.frame()) {
                    let what = format!("{when}, to {}: {}", request.words(), expected.words());
                    return Err(broken(what, came.map_or_else(|| "no answer".to_owned(), Words::words)));
                }
            }
            if let Some(more) = got.get(part.len()..).filter(|more| !more.is_empty()) {
                return Err(broken(
                    format!("{when}: one answer to each request"),
                    format!("also {}", more.words()),
                ));
            }
        }
        Ok(())
    }

    /// The answers to requests with one answer each, in order.
    pub(super) fn answers(&mut self, requests: &[HostMessage]) -> Result<Vec<DriveMessage>, Failure> {
        let mut answers = Vec::new();
        for part in requests.chunks(BURST) {
            let got = self.burst(part)?;
            if got.len() != part.len() {
                return Err(broken(format!("one answer to each of {}", part.words()), got.words()));
            }
            answers.extend(got);
        }
        Ok(answers)
    }
}

/// A request and the `CommandResult` that answers it.
pub(super) fn result<Request: Payload + Into<HostMessage>>(
    request: Request,
    outcome: Outcome,
    state: State,
) -> Exchange {
    refused(request, outcome, state, 0)
}

/// As [`result`], of a refusal with this detail.
pub(super) fn refused<Request: Payload + Into<HostMessage>>(
    request: Request,
    outcome: Outcome,
    state: State,
    detail: u32,
) -> Exchange {
    let kind = Request::LAYOUT.kind;
    let result = CommandResult { request: kind, outcome, state, detail, device_time_us: None };
    (request.into(), result.into())
}

/// The report of a parameter without a detail.
pub(super) fn reported(index: u8, outcome: Outcome, value: ParameterValue, state: State) -> ParameterReport {
    ParameterReport { index, outcome, value, state, detail: 0, device_time_us: None }
}

/// A read of a parameter with this value in force.
pub(super) fn reads(index: u8, value: ParameterValue, state: State) -> Exchange {
    (GetParameter { index }.into(), reported(index, Accepted, value, state).into())
}

/// A setting, its outcome, and the value in force afterwards.
pub(super) fn sets(
    index: u8,
    value: ParameterValue,
    outcome: Outcome,
    in_force: ParameterValue,
    state: State,
) -> Exchange {
    (SetParameter { index, value }.into(), reported(index, outcome, in_force, state).into())
}
