//! Several requests in one write, with their answers.

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{CommandResult, GetParameter, ParameterReport, SetParameter};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use super::assertion::{Failure, RuleResult, broken};
use super::client::Client;
use super::words::Words;

/// Requests in one write. More would gain little, and a drive on a slow line buffers the answers.
pub(super) const BURST: usize = 8;

/// A request and its only answer.
pub(super) type Exchange = (HostMessage, DriveMessage);

impl Client {
    /// Sends requests in one write and returns all of their answers but `Log`.
    pub(super) fn burst(&mut self, requests: &[HostMessage]) -> Result<Vec<DriveMessage>, Failure> {
        let bytes: Vec<u8> = requests.iter().flat_map(|request| request.frame().to_vec()).collect();
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
                    let what = format!("{when}, to {}: {}", described(request), expected.words());
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
                let names: Vec<_> = part.iter().map(described).collect();
                return Err(broken(format!("one answer to each of {}", names.join(", ")), got.words()));
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
    let kind = Request::LAYOUT.kind;
    (request.into(), CommandResult { request: kind, outcome, state }.into())
}

/// A read of a parameter with this value in force.
pub(super) fn reads(index: u8, value: ParameterValue, state: State) -> Exchange {
    let report = ParameterReport { index, outcome: Outcome::Accepted, value, state };
    (GetParameter { index }.into(), report.into())
}

/// A setting, its outcome, and the value in force afterwards.
pub(super) fn sets(
    index: u8,
    value: ParameterValue,
    outcome: Outcome,
    in_force: ParameterValue,
    state: State,
) -> Exchange {
    let report = ParameterReport { index, outcome, value: in_force, state };
    (SetParameter { index, value }.into(), report.into())
}

/// A request in words: its name, and what distinguishes it from others of the kind.
pub(super) fn described(request: &HostMessage) -> String {
    let name = request.layout().name;
    match request {
        HostMessage::Hello(it) => {
            format!("{name} of version {}, session {}", it.protocol_version, it.session)
        }
        HostMessage::DescribeParameter(it) => format!("{name} {}", it.index),
        HostMessage::GetParameter(it) => format!("{name} {}", it.index),
        HostMessage::SetParameter(it) => format!("{name} {} = {:?} {}", it.index, it.value.ty(), it.value),
        HostMessage::Arm(it) => format!("{name} of session {}", it.session),
        HostMessage::Start(it) => format!("{name} of session {}", it.session),
        HostMessage::DescribeLaw(it) => format!("{name} {}", it.index),
        HostMessage::DescribeSignal(it) => format!("{name} {}", it.index),
        HostMessage::DescribeChoice(it) => format!("{name} {} of parameter {}", it.choice, it.parameter),
        HostMessage::Subscribe(it) => format!("{name} to {:#x}, every {}", it.signals, it.every),
        HostMessage::EncoderSample(it) => format!("{name} {}", it.sequence),
        HostMessage::Reference(it) => format!("{name} {}", it.number),
        HostMessage::EnterLoader(it) => format!("{name} of session {}", it.session),
        HostMessage::Stop(_)
        | HostMessage::EmergencyStop(_)
        | HostMessage::ClearFault(_)
        | HostMessage::Reset(_) => name.to_owned(),
    }
}
