//! Entries as lines for people.

use std::fmt::{self, Write};

use lashloop_protocol::Counters;
use lashloop_protocol::layout::Direction;

use super::entry::{Entry, Location};

/// Bytes of a bad frame that are shown.
const SHOWN: usize = 24;

/// The heading above entries of a stream, or of a capture.
#[must_use]
pub fn heading(capture: bool) -> String {
    if capture {
        format!("{:>8} {:>16}  {:<13}  {:<20}  fields", "packet", "time s", "direction", "message")
    } else {
        format!("{:>8}  {:<13}  {:<20}  fields", "offset", "direction", "message")
    }
}

/// One entry.
#[must_use]
pub fn line(entry: &Entry) -> String {
    let mut line = match entry.location {
        Location::Offset(offset) => format!("{offset:>8}"),
        Location::Packet { number, time_ns, .. } => {
            format!("{number:>8} {:>6}.{:09}", time_ns / 1_000_000_000, time_ns % 1_000_000_000)
        }
    };
    // Writing to a string does not fail.
    let _ = describe(&mut line, entry);
    line.truncate(line.trim_end().len());
    line
}

fn describe(line: &mut String, entry: &Entry) -> fmt::Result {
    let direction = match entry.direction() {
        Some(Direction::HostToDrive) => "host -> drive",
        Some(Direction::DriveToHost) => "drive -> host",
        None => "?",
    };
    write!(line, "  {direction:<13}  ")?;
    match &entry.message {
        Ok(message) => {
            write!(line, "{:<20}  ", message.layout.name)?;
            for (at, field) in message.fields.iter().enumerate() {
                let separator = if at == 0 { "" } else { ", " };
                write!(line, "{separator}{} {}", field.name, field.value)?;
                if let Some(unit) = field.unit {
                    // 57 x 0.1 us
                    let times = if unit.starts_with(|c: char| c.is_ascii_digit()) { "x " } else { "" };
                    write!(line, " {times}{unit}")?;
                }
            }
        }
        Err(error) => {
            write!(line, "{:<20}  {error}:", "BAD")?;
            for byte in entry.bytes.iter().take(SHOWN) {
                write!(line, " {byte:02x}")?;
            }
            if entry.bytes.len() > SHOWN {
                write!(line, " ...")?;
            }
        }
    }
    Ok(())
}

/// The counters, after the last entry.
#[must_use]
pub fn counters(counters: &Counters) -> String {
    let Counters { messages, discarded_bytes, oversized, malformed, crc_errors, refused } = counters;
    format!(
        "{messages} messages; bad: {crc_errors} by CRC, {malformed} malformed, {oversized} oversized, {refused} refused \
         ({discarded_bytes} bytes)"
    )
}
