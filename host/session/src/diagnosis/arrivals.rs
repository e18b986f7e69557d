//! What arrived since the last awaited frame.

use std::time::{Duration, Instant};

use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::layout::MessageLayout;
use lashloop_protocol::message::{FaultReport, Log, Telemetry};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, Message, PROTOCOL_VERSION};

use super::bad_frame::{CrcVariant, Refusal};
use super::echoed::OtherIndex;
use super::raw_bytes::RawBytes;

/// Kinds of a drive, by their low five bits.
const KINDS: usize = 32;

/// Counts of what arrived since the last frame that the bench awaited. Frames that it awaited are not counted.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Arrivals {
    /// Bytes.
    pub bytes: u64,
    /// Reads that returned bytes.
    pub reads: u32,
    /// Beginning of the wait, in the link's time.
    pub(super) since: Option<Instant>,
    /// Latest time of the wait, in the link's time.
    pub(super) until: Option<Instant>,
    /// Reads of the first and of the last byte, in the link's time.
    pub(super) first_and_last: Option<(Instant, Instant)>,
    pub(super) good: [u32; KINDS],
    /// Good answers to requests that this bench has not sent since it opened the line.
    pub unrequested: u32,
    /// Each `Identity` of a session other than that of the last `Hello`.
    pub other_identities: u32,
    /// Session of the last of these, and the one of the `Hello`.
    pub other_session: Option<(u32, u32)>,
    /// Answers with another number than that of the last request.
    pub other_numbers: u32,
    /// Number of the last of these, and the one of the request.
    pub other_number: Option<(u8, u8)>,
    /// The last message with the number of the request that is only a part of the answer.
    pub part: Option<&'static str>,
    /// The last answer with the number of the request and another index.
    pub other_index: Option<OtherIndex>,
    /// The last fault that the drive has reported, with its detail.
    pub fault: Option<(FaultCode, u32)>,
    /// Frames that this bench has sent itself.
    pub own_frames: u32,
    /// Requests of another host.
    pub host_requests: u32,
    /// Name of the last of these.
    pub host_request: Option<&'static str>,
    /// Whole frames that aren't messages of a drive, without those of hosts.
    pub refused: u32,
    /// Whole frames of kinds that this bench doesn't know.
    pub unknown: u32,
    /// The first frame refused or unknown, an `Identity` before any other.
    pub refusal: Option<Refusal>,
    /// Frames with a wrong CRC.
    pub crc_errors: u32,
    /// Frames with invalid stuffing, or too short for a CRC.
    pub malformed: u32,
    /// Frames longer than the longest.
    pub oversized: u32,
    /// A usual mistake that explains a wrong CRC among them.
    pub crc_variant: Option<CrcVariant>,
    /// Most bytes without a delimiter.
    pub longest_run: usize,
    /// Delimiters with no byte before them.
    pub lone_delimiters: u64,
    /// The bytes outside good frames.
    pub raw: RawBytes,
}

impl Arrivals {
    /// Duration of the wait.
    #[must_use]
    pub fn window(&self) -> Duration {
        match (self.since, self.until) {
            (Some(since), Some(until)) => until.saturating_duration_since(since),
            _ => Duration::ZERO,
        }
    }

    /// Bytes per second over the wait; 0 without a wait.
    #[must_use]
    pub fn bytes_per_s(&self) -> f64 {
        per_s(self.bytes, self.window())
    }

    /// Good frames that the bench did not await, by message, the most frequent first.
    #[must_use]
    pub fn good_frames(&self) -> Vec<(&'static MessageLayout, u32)> {
        let layouts = DriveMessage::LAYOUTS.iter();
        let counted = layouts.map(|layout| (layout, self.good[slot(layout.kind)]));
        let mut counted: Vec<_> = counted.filter(|(_, count)| *count > 0).collect();
        counted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        counted
    }

    /// Number of good frames that the bench did not await.
    #[must_use]
    pub fn good_count(&self) -> u32 {
        self.good.iter().fold(0, |sum, count| sum.saturating_add(*count))
    }

    /// Damaged frames.
    #[must_use]
    pub fn damaged(&self) -> u32 {
        self.oversized.saturating_add(self.malformed).saturating_add(self.crc_errors)
    }

    /// Good frames that answer no request.
    #[must_use]
    pub fn unsolicited(&self) -> u32 {
        let kinds = [Log::LAYOUT, Telemetry::LAYOUT, FaultReport::LAYOUT].map(|layout| layout.kind);
        kinds.iter().fold(0, |sum, kind| sum.saturating_add(self.good[slot(*kind)]))
    }

    /// Good frames that answer no request, per second.
    #[must_use]
    pub fn unsolicited_per_s(&self) -> f64 {
        per_s(self.unsolicited().into(), self.window())
    }

    /// Whether single bytes arrived, with pauses: over most of the wait, or as the beginning of an `Identity`.
    #[must_use]
    pub fn trickles(&self) -> bool {
        let Some((first, last)) = self.first_and_last else { return false };
        let spread = last.saturating_duration_since(first);
        // A code byte, kind, number and version.
        let is_identity = matches!(self.raw.head(), [_, 0x81, _, PROTOCOL_VERSION, ..]);
        self.bytes >= 3
            && 2 * u64::from(self.reads) >= self.bytes
            && (2 * spread >= self.window() || is_identity)
            && self.bytes_per_s() < 100.0
    }
}

pub(super) fn slot(kind: u8) -> usize {
    usize::from(kind) % KINDS
}

fn per_s(count: u64, time: Duration) -> f64 {
    if time.is_zero() { 0.0 } else { count as f64 / time.as_secs_f64() }
}
