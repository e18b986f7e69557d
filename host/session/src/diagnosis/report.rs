//! A diagnosis and its sentences.

use std::fmt;

use lashloop_protocol::MAX_FRAME;
use lashloop_protocol::hex::Hex;

use super::arrivals::Arrivals;
use super::cause::Cause;
use crate::text::counted;

/// First bytes that are shown.
const SHOWN: usize = 8;
/// Messages that are named.
const NAMED: usize = 3;

/// What arrived instead of an answer, and why. Its text is one line: the numbers, the probable cause, the remedy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnosis {
    /// What arrived since the last awaited frame.
    pub arrivals: Arrivals,
    /// The probable cause.
    pub cause: Cause,
}

impl Diagnosis {
    pub(super) fn new(arrivals: Arrivals, is_connected: bool) -> Self {
        let cause = Cause::of(&arrivals, is_connected);
        Self { arrivals, cause }
    }

    /// Whether nothing arrived that needs an explanation: no byte, or logs and telemetry of a drive that answered before.
    #[must_use]
    pub fn is_silence(&self) -> bool {
        matches!(self.cause, Cause::NoDrive | Cause::Hang)
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}: {}", self.arrivals, self.cause)
    }
}

/// What arrived, in numbers.
impl fmt::Display for Arrivals {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { bytes, .. } = self;
        if *bytes == 0 {
            return out.write_str("no byte arrived");
        }
        let window_s = self.window().as_secs_f64();
        write!(out, "{} arrived in {window_s:.1} s", counted(*bytes, "byte"))?;
        let parts = self.parts();
        if !parts.is_empty() {
            write!(out, " with {}", parts.join(", "))?;
        }
        if self.lone_delimiters == *bytes {
            return out.write_str(", all of them zero");
        }
        if self.raw.count == *bytes && self.longest_run as u64 == *bytes {
            out.write_str(", none of them zero")?;
        }
        if self.is_undecodable() && !self.raw.is_text() {
            let shown = &self.raw.head()[..self.raw.head().len().min(SHOWN)];
            write!(out, ", beginning {:#}", Hex(shown))?;
        }
        Ok(())
    }
}

impl Arrivals {
    /// The frames among the bytes, as in "25 Identity".
    fn parts(&self) -> Vec<String> {
        let good = self.good_frames();
        let mut parts: Vec<_> =
            good.iter().take(NAMED).map(|(layout, count)| format!("{count} {}", layout.name)).collect();
        if let Some(rest) = good.get(NAMED..).filter(|rest| !rest.is_empty()) {
            let count = rest.iter().map(|(_, count)| u64::from(*count)).sum();
            parts.push(counted(count, "other good frame"));
        }
        let others = [
            (self.own_frames, "frame of this bench"),
            (self.host_requests, "request of another host"),
            (self.refused, "refused frame"),
            (self.unknown, "frame of an unknown kind"),
            (self.crc_errors, "frame with a wrong CRC"),
            (self.malformed, "malformed frame"),
        ];
        let others = others.into_iter().filter(|(count, _)| *count > 0);
        parts.extend(others.map(|(count, noun)| counted(count.into(), noun)));
        if self.oversized > 0 {
            parts.push(format!("{} longer than {MAX_FRAME} bytes", counted(self.oversized.into(), "frame")));
        }
        parts
    }

    /// Whether bytes arrived and no whole frame.
    fn is_undecodable(&self) -> bool {
        let whole = [self.good_count(), self.own_frames, self.host_requests, self.refused, self.unknown];
        whole.iter().all(|count| *count == 0) && self.raw.count > 0
    }
}
