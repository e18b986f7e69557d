//! Counts what arrives. An awaited frame that arrives whole costs an addition; only other frames are looked at.

use std::time::Instant;

use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::layout::has_number;
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{
    Decoder, DriveMessage, FrameError, HostMessage, MAX_FRAME, Message, Numbered, message,
};

use super::arrivals::{Arrivals, slot};
use super::bad_frame::{BadFrame, Refusal};
use super::echoed::OtherIndex;
use super::report::Diagnosis;

/// Frames sent that an echo is compared with.
const REMEMBERED: usize = 8;
/// Longest frame without its delimiter, in bytes.
const LONGEST: usize = MAX_FRAME - 1;

/// Counts what arrives on a line.
#[derive(Default)]
pub(crate) struct Collector {
    arrivals: Arrivals,
    /// Whether `arrivals` has more than bytes and times.
    is_mixed: bool,
    /// The first bytes since the last delimiter, perhaps with older ones behind them.
    partial: heapless::Vec<u8, LONGEST>,
    /// All bytes since the last delimiter.
    partial_len: usize,
    sent: [Option<Numbered<HostMessage>>; REMEMBERED],
    next_sent: usize,
    /// The last request with a number.
    request: Option<Numbered<HostMessage>>,
    /// Kinds of the requests sent, a bit each.
    sent_kinds: u64,
    /// Session of the last `Hello` sent.
    session: Option<u32>,
    /// Whether an awaited frame has ever arrived.
    is_connected: bool,
    /// Answers since the line was opened that nothing awaited.
    surplus_answers: u32,
}

impl Collector {
    /// The line was cleared.
    pub(crate) fn clear(&mut self) {
        self.restart();
        self.partial_len = 0;
    }

    /// A message is sent.
    pub(crate) fn sent(&mut self, message: &Numbered<HostMessage>) {
        self.sent[self.next_sent] = Some(*message);
        self.next_sent = (self.next_sent + 1) % REMEMBERED;
        let layout = message.message.layout();
        self.sent_kinds |= 1_u64.checked_shl(layout.kind.into()).unwrap_or(0);
        if layout.has_number() {
            self.request = Some(*message);
        }
        if let HostMessage::Hello(hello) = message.message {
            self.session = Some(hello.session);
        }
    }

    /// Bytes are sent, frames or not.
    pub(crate) fn sent_bytes(&mut self, mut bytes: &[u8]) {
        let mut decoder = Decoder::new();
        while let Some(message) = decoder.next::<HostMessage>(&mut bytes) {
            if let Ok(message) = message {
                self.sent(&message);
            }
        }
    }

    /// The bench waits, and this is the time.
    #[inline]
    pub(crate) fn waits(&mut self, now: Instant) {
        self.arrivals.since.get_or_insert(now);
        self.arrivals.until = Some(now);
    }

    /// A read returned `count` bytes.
    #[inline]
    pub(crate) fn read(&mut self, count: usize) {
        let arrivals = &mut self.arrivals;
        arrivals.bytes += count as u64;
        arrivals.reads = arrivals.reads.saturating_add(1);
        if let Some(now) = arrivals.until {
            let first = arrivals.first_and_last.map_or(now, |(first, _)| first);
            arrivals.first_and_last = Some((first, now));
        }
    }

    /// The frame in progress was good.
    #[inline]
    pub(crate) fn good(&mut self) {
        self.partial_len = 0;
    }

    /// The bench awaited the message that was decoded last; `left` bytes behind it are read and not decoded yet.
    #[inline]
    pub(crate) fn awaited(&mut self, left: usize) {
        self.is_connected = true;
        if self.is_mixed {
            self.restart();
        }
        let arrivals = &mut self.arrivals;
        (arrivals.bytes, arrivals.reads, arrivals.lone_delimiters) = (left as u64, u32::from(left > 0), 0);
        (arrivals.since, arrivals.first_and_last) = (None, None);
        arrivals.raw.forget_delimiters();
    }

    fn restart(&mut self) {
        self.arrivals = Arrivals::default();
        self.is_mixed = false;
    }

    /// The bench did not await this message.
    pub(crate) fn other(&mut self, answer: &Numbered<DriveMessage>) {
        let message = &answer.message;
        self.is_mixed = true;
        let count = &mut self.arrivals.good[slot(message.layout().kind)];
        *count = count.saturating_add(1);
        if !matches!(
            message,
            DriveMessage::Telemetry(_) | DriveMessage::FaultReport(_) | DriveMessage::Log(_)
        ) {
            self.surplus_answers = self.surplus_answers.saturating_add(1);
        }
        if !self.is_requested(message) {
            self.arrivals.unrequested = self.arrivals.unrequested.saturating_add(1);
        }
        if let (DriveMessage::Identity(it), Some(session)) = (message, self.session)
            && it.session != session
        {
            self.arrivals.other_identities = self.arrivals.other_identities.saturating_add(1);
            self.arrivals.other_session = Some((it.session, session));
        }
        if let DriveMessage::FaultReport(it) = message {
            self.arrivals.fault = Some((it.code, it.detail));
        }
        self.compare(answer);
    }

    /// Compares an answer with the last request.
    fn compare(&mut self, Numbered { number, message }: &Numbered<DriveMessage>) {
        let Some(request) = self.request.filter(|_| message.layout().has_number()) else { return };
        // The refusal of a sample has number 0, as the sample has none.
        if matches!(message, DriveMessage::CommandResult(it) if !has_number(it.request)) {
            return;
        }
        if *number == request.number {
            match OtherIndex::of(message, &request.message) {
                Some(other) => self.arrivals.other_index = Some(other),
                None => self.arrivals.part = Some(message.layout().name),
            }
            return;
        }
        self.arrivals.other_numbers = self.arrivals.other_numbers.saturating_add(1);
        self.arrivals.other_number = Some((*number, request.number));
    }

    /// Answers since the line was opened that nothing awaited: late, doubled, or to the requests of another host.
    pub(crate) fn surplus_answers(&self) -> u32 {
        self.surplus_answers
    }

    /// Whether this bench has sent a request of the kind that causes this message.
    fn is_requested(&self, message: &DriveMessage) -> bool {
        use message::{
            DescribeChoice, DescribeLaw, DescribeParameter, DescribeSignal, EncoderSample, GetParameter,
            Hello, ReadCapture, SetParameter, Start, Stop,
        };
        let bit = |kind: u8| 1_u64.checked_shl(kind.into()).unwrap_or(0);
        let causes = match message {
            DriveMessage::Identity(_) => bit(Hello::LAYOUT.kind),
            DriveMessage::ParameterDescription(_) => bit(DescribeParameter::LAYOUT.kind),
            DriveMessage::ParameterReport(_) => {
                bit(GetParameter::LAYOUT.kind)
                    | bit(SetParameter::LAYOUT.kind)
                    | bit(DescribeParameter::LAYOUT.kind)
            }
            DriveMessage::CommandResult(it) => bit(it.request),
            DriveMessage::LawDescription(_) => bit(DescribeLaw::LAYOUT.kind),
            DriveMessage::SignalDescription(_) => bit(DescribeSignal::LAYOUT.kind),
            DriveMessage::ChoiceDescription(_) => bit(DescribeChoice::LAYOUT.kind),
            DriveMessage::TorqueAnswer(_) => bit(EncoderSample::LAYOUT.kind),
            DriveMessage::LineReport(_) => bit(Stop::LAYOUT.kind),
            DriveMessage::CaptureRows(_) => bit(ReadCapture::LAYOUT.kind),
            DriveMessage::BenchSample(_) => bit(Start::LAYOUT.kind),
            DriveMessage::Telemetry(_) | DriveMessage::FaultReport(_) | DriveMessage::Log(_) => return true,
        };
        self.sent_kinds & causes != 0
    }

    /// Bytes without a delimiter at their end, after any number of lone delimiters.
    pub(crate) fn partial(&mut self, bytes: &[u8]) {
        let bytes = self.without_lone_delimiters(bytes);
        if bytes.is_empty() {
            return;
        }
        let (old, new) = (self.partial_len, self.partial_len + bytes.len());
        self.partial_len = new;
        self.partial.truncate(old);
        if new <= LONGEST && self.partial.extend_from_slice(bytes).is_ok() {
            return;
        }
        self.is_mixed = true;
        if old <= LONGEST {
            self.arrivals.raw.add(&self.partial[..old]);
        }
        self.arrivals.raw.add(bytes);
        self.arrivals.longest_run = self.arrivals.longest_run.max(new);
    }

    /// A frame was bad. `bytes` ends with its delimiter.
    pub(crate) fn bad(&mut self, bytes: &[u8], error: &FrameError) {
        self.is_mixed = true;
        self.partial(bytes.strip_suffix(&[DELIMITER]).unwrap_or(bytes));
        let len = std::mem::take(&mut self.partial_len);
        let arrivals = &mut self.arrivals;
        arrivals.longest_run = arrivals.longest_run.max(len);
        let frame = match self.partial.get(..len) {
            Some(stuffed) => {
                arrivals.raw.add(stuffed);
                BadFrame::of(stuffed, error)
            }
            None => BadFrame::Damaged,
        };
        arrivals.raw.add_delimiters(1);
        let count = match error {
            FrameError::Oversized { .. } => &mut arrivals.oversized,
            FrameError::Stuffing { .. } | FrameError::TooShort { .. } | FrameError::Truncated { .. } => {
                &mut arrivals.malformed
            }
            FrameError::Crc { .. } => &mut arrivals.crc_errors,
            FrameError::Body(_) => match frame {
                BadFrame::OfHost(ref message) if self.sent.contains(&Some(*message)) => {
                    &mut arrivals.own_frames
                }
                BadFrame::OfHost(ref message) => {
                    arrivals.host_request = Some(message.message.layout().name);
                    &mut arrivals.host_requests
                }
                _ if matches!(error, FrameError::Body(BodyError::UnknownKind { .. })) => {
                    &mut arrivals.unknown
                }
                _ => &mut arrivals.refused,
            },
        };
        *count = count.saturating_add(1);
        match frame {
            BadFrame::Crc(variant) => arrivals.crc_variant = Some(variant),
            BadFrame::Refused(refusal) => {
                let is_better = |it: &Refusal| refusal.is_identity() && !it.is_identity();
                if arrivals.refusal.as_ref().is_none_or(is_better) {
                    arrivals.refusal = Some(refusal);
                }
            }
            BadFrame::OfHost(_) | BadFrame::Damaged => {}
        }
    }

    fn without_lone_delimiters<'a>(&mut self, bytes: &'a [u8]) -> &'a [u8] {
        if self.partial_len > 0 {
            return bytes;
        }
        let lone = bytes.iter().take_while(|byte| **byte == DELIMITER).count();
        self.arrivals.lone_delimiters += lone as u64;
        self.arrivals.raw.add_delimiters(lone);
        &bytes[lone..]
    }

    /// Whether bytes have arrived since the last awaited frame.
    pub(crate) fn has_arrivals(&self) -> bool {
        self.arrivals.bytes > 0
    }

    /// What has arrived since the last awaited frame, and its probable cause.
    pub(crate) fn diagnosis(&self) -> Diagnosis {
        let mut arrivals = self.arrivals.clone();
        if let Some(partial) = self.partial.get(..self.partial_len) {
            arrivals.raw.add(partial);
        }
        arrivals.longest_run = arrivals.longest_run.max(self.partial_len);
        Diagnosis::new(arrivals, self.is_connected)
    }
}
