//! A diagnosis and its sentences.

use std::fmt;

use lashloop_protocol::MAX_FRAME;
use lashloop_protocol::hex::Hex;

use super::arrivals::Arrivals;
use super::cause::Cause;

/// First bytes that are shown.
const SHOWN: usize = 8;
/// Messages that are named.
const NAMED: usize = 3;

/// What arrived in place of an answer, and why. Its text is one line: the numbers, the probable cause, the remedy.
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

    /// Whether nothing arrived.
    #[must_use]
    pub fn is_silence(&self) -> bool {
        self.arrivals.bytes == 0
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
        let good = self.good_frames();
        if !good.is_empty() {
            let named = good.iter().take(NAMED).map(|(layout, count)| format!("{count} {}", layout.name));
            let rest = if good.len() > NAMED { ", ..." } else { "" };
            let list = named.collect::<Vec<_>>().join(", ");
            write!(out, ", {} among them ({list}{rest})", counted(self.good_count().into(), "good frame"))?;
        }
        for (count, noun) in [
            (self.own_frames, "frame of this bench"),
            (self.host_requests, "request of another host"),
            (self.refused, "refused frame"),
            (self.crc_errors, "frame with a wrong CRC"),
            (self.malformed, "malformed frame"),
        ] {
            if count > 0 {
                write!(out, ", {}", counted(count.into(), noun))?;
            }
        }
        if self.oversized > 0 {
            write!(out, ", {} longer than {MAX_FRAME} bytes", counted(self.oversized.into(), "frame"))?;
        }
        if self.lone_delimiters == *bytes {
            return out.write_str(", all of them zero");
        }
        if self.raw.count == *bytes && self.longest_run as u64 == *bytes {
            out.write_str(", none of them zero")?;
        }
        if self.is_undecodable() && !self.raw.is_text() {
            let shown = &self.raw.head()[..self.raw.head().len().min(SHOWN)];
            write!(out, ", the first {:#}", Hex(shown))?;
        }
        Ok(())
    }
}

impl Arrivals {
    /// Whether bytes arrived and no whole frame.
    fn is_undecodable(&self) -> bool {
        let whole = [self.good_count(), self.own_frames, self.host_requests, self.refused];
        whole.iter().all(|count| *count == 0) && self.raw.count > 0
    }
}

fn counted(count: u64, noun: &str) -> String {
    let (first, rest) = noun.split_once(' ').unwrap_or((noun, ""));
    match (count, rest) {
        (1, _) => format!("1 {noun}"),
        // "good frames", but "frames of this bench".
        (_, "frame") => format!("{count} {noun}s"),
        (_, "") => format!("{count} {first}s"),
        (_, rest) if matches!(first, "frame" | "request") => format!("{count} {first}s {rest}"),
        _ => format!("{count} {noun}s"),
    }
}
