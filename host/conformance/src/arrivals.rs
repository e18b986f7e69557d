//! Every message that arrives, checked in one place: whose answer it is, and its device time.

use std::collections::{BTreeSet, VecDeque};

use lashloop_protocol::layout::has_number;
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{Decoder, FrameError};

use super::assertion::{Failure, RuleResult, broken};
use super::words::Words;
use crate::prelude::wire::*;

/// A request that waits for its answers.
#[derive(Clone, Copy)]
struct Waiting {
    kind: u8,
    number: u8,
    /// Of a sample.
    sequence: Option<u16>,
    /// Whether a `CommandResult` follows the `Identity`.
    is_of_other_version: bool,
    is_answered: bool,
}

impl Waiting {
    const fn of(kind: u8, number: u8) -> Self {
        Self { kind, number, sequence: None, is_of_other_version: false, is_answered: false }
    }

    /// Whether this message may answer the request.
    fn takes(&self, number: u8, message: &DriveMessage) -> bool {
        match message {
            DriveMessage::TorqueAnswer(it) => self.sequence == Some(it.sequence),
            DriveMessage::CommandResult(it) if !has_number(it.request) => {
                self.kind == it.request && number == 0
            }
            _ => has_number(self.kind) && self.number == number,
        }
    }

    /// Whether no other numbered answer follows this one.
    const fn ends_with(&self, message: &DriveMessage) -> bool {
        match message {
            DriveMessage::LineReport(_) => false,
            DriveMessage::Identity(_) => !self.is_of_other_version,
            _ => true,
        }
    }
}

/// What has been sent and what may arrive.
pub(super) struct Arrivals {
    /// Finds the requests in the bytes sent, as the drive does.
    receiver: Decoder,
    waiting: VecDeque<Waiting>,
    /// Number of the last request.
    number: u8,
    has_device_time: bool,
    /// Flags that may be set.
    flags: TorqueFlags,
    /// Device time of the last message that has one.
    pub(super) device_us: Option<u32>,
    /// Whether answers to no request are late ones.
    pub(super) skips_late: bool,
    /// Values that the drive has sent, by their lists.
    pub(super) seen: BTreeSet<(u8, u8)>,
}

impl Arrivals {
    pub(super) fn new(identity: &Identity) -> Self {
        Self {
            receiver: Decoder::new(),
            waiting: VecDeque::new(),
            number: u8::MAX,
            has_device_time: identity.capabilities.contains(Capabilities::DEVICE_TIME),
            flags: if identity.minor_version > MINOR_VERSION {
                TorqueFlags::all()
            } else {
                TorqueFlags::from_bits_retain(u8::MAX)
            },
            device_us: identity.device_time_us,
            skips_late: false,
            seen: BTreeSet::new(),
        }
    }

    /// The number of the next request. Every second one, so that an answer with the next number answers nothing.
    pub(super) const fn next_number(&mut self) -> u8 {
        self.number = self.number.wrapping_add(2);
        self.number
    }

    /// Notes the requests among bytes that are sent.
    pub(super) fn sent(&mut self, mut bytes: &[u8]) {
        while let Some(frame) = self.receiver.next::<HostMessage>(&mut bytes) {
            let request = match frame {
                Ok(Numbered { number, message }) => {
                    let request = Waiting::of(message.layout().kind, number);
                    let is_of_other_version =
                        matches!(message, HostMessage::Hello(it) if it.protocol_version != PROTOCOL_VERSION);
                    match message {
                        HostMessage::EncoderSample(it) => Waiting { sequence: Some(it.sequence), ..request },
                        _ => Waiting { is_of_other_version, ..request },
                    }
                }
                Err(FrameError::Body(BodyError::UnknownKind { kind, number })) if has_number(kind) => {
                    Waiting::of(kind, number)
                }
                Err(_) => continue,
            };
            self.waiting.push_back(request);
        }
    }

    /// Nothing waits any more: another answer would be one too many.
    pub(super) fn close(&mut self) {
        self.waiting.clear();
    }

    /// As after the delimiter that ends a partial frame.
    pub(super) fn forget_partial(&mut self) {
        self.receiver.forget_partial();
    }

    /// Whether a request waits that every drive answers.
    pub(super) fn is_waiting(&self) -> bool {
        self.waiting.iter().any(|it| !it.is_answered && it.kind != Reference::LAYOUT.kind)
    }

    /// Checks a message, and returns it without its device time and the flags of a newer version; `None` if it is late.
    pub(super) fn take(&mut self, arrived: &Numbered<DriveMessage>) -> Result<Option<DriveMessage>, Failure> {
        let Numbered { number, mut message } = *arrived;
        self.see(&message);
        self.check_time(&mut message)?;
        match &mut message {
            DriveMessage::TorqueAnswer(it) => it.status.flags &= self.flags,
            DriveMessage::BenchSample(it) => it.status.flags &= self.flags,
            _ => {}
        }
        if is_unasked(&message) {
            return Ok(Some(message));
        }
        let takes = |it: &Waiting| !it.is_answered && it.takes(number, &message);
        let Some(place) = self.waiting.iter().position(takes) else {
            return if self.skips_late { Ok(None) } else { Err(surplus(number, &message)) };
        };
        // Answers come in the order of the requests.
        self.waiting.drain(..place);
        if let Some(request) = self.waiting.front_mut() {
            request.is_answered = request.ends_with(&message);
        }
        Ok(Some(message))
    }

    /// Takes the device time from a message.
    fn check_time(&mut self, message: &mut DriveMessage) -> RuleResult {
        let name = message.layout().name;
        let Some(time_us) = message.device_time_us_mut().map(Option::take) else { return Ok(()) };
        if time_us.is_some() != self.has_device_time {
            let with = if self.has_device_time { "with" } else { "without" };
            let got = time_us.map_or_else(|| "none".to_owned(), |time_us| format!("{time_us} us"));
            return Err(broken(format!("{name} {with} device time, by the capability of the drive"), got));
        }
        let earlier = std::mem::replace(&mut self.device_us, time_us);
        match (earlier, time_us) {
            (Some(earlier), Some(time_us)) if time_us.wrapping_sub(earlier) > u32::MAX / 2 => Err(broken(
                format!("{name} with a device time of {earlier} us or later, as in the message before"),
                format!("{time_us} us"),
            )),
            _ => Ok(()),
        }
    }

    fn see(&mut self, message: &DriveMessage) {
        let (state, other) = match message {
            DriveMessage::Identity(it) => (Some(it.state), None),
            DriveMessage::CommandResult(it) => (Some(it.state), Some((OUTCOME_NAMES, it.outcome.byte()))),
            DriveMessage::ParameterReport(it) => (Some(it.state), Some((OUTCOME_NAMES, it.outcome.byte()))),
            DriveMessage::TorqueAnswer(it) => {
                let set = (4..u8::BITS).map(|bit| 1 << bit).filter(|mask| it.status.flags.bits() & mask != 0);
                self.seen.extend(set.map(|mask| (FLAG_NAMES, mask)));
                (Some(it.status.state), None)
            }
            DriveMessage::FaultReport(it) => (None, Some((FAULT_NAMES, it.code.byte()))),
            _ => (None, None),
        };
        self.seen.insert((KIND_NAMES, message.layout().kind));
        self.seen.extend(state.map(|state| (STATE_NAMES, state.byte())));
        self.seen.extend(other);
    }
}

/// Whether the message may come without a request, or follows one that has no number.
const fn is_unasked(message: &DriveMessage) -> bool {
    matches!(
        message,
        DriveMessage::Log(_)
            | DriveMessage::FaultReport(_)
            | DriveMessage::Telemetry(_)
            | DriveMessage::BenchSample(_)
    )
}

fn surplus(number: u8, message: &DriveMessage) -> Failure {
    let words = message.words();
    let with_number =
        if message.layout().has_number() { format!(", number {number}") } else { String::new() };
    broken("one answer to each request, in their order and with its number", format!("{words}{with_number}"))
}
