//! Entries as lines of text.

use std::fmt::{self, Write};

use lashloop_protocol::Counters;
use lashloop_protocol::field_value::FieldValue;
use lashloop_protocol::hex::Hex;
use lashloop_protocol::layout::Direction;
use lashloop_session::counted;

use super::entry::{Entry, Location};
use super::subscription::Label;

/// Printed bytes of a bad frame.
const SHOWN: usize = 24;

/// The heading for the entries of a stream, or of a capture.
#[must_use]
pub fn heading(capture: bool) -> String {
    if capture {
        format!("{:>8} {:>16}  {:<13}  {:<20}  fields", "packet", "time s", "direction", "message")
    } else {
        format!("{:>8}  {:<13}  {:<20}  fields", "offset", "direction", "message")
    }
}

#[must_use]
pub fn line(entry: &Entry) -> String {
    let mut line = match entry.location {
        Location::Stream { offset } => format!("{offset:>8}"),
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
    match (&entry.message, entry.unknown()) {
        (Ok(message), _) => {
            write!(line, "{:<20}  ", message.layout.name)?;
            let number = message.number.map(|number| write!(line, "#{number}"));
            let has_number = number.transpose()?.is_some();
            for (at, (field, value)) in message.fields().enumerate() {
                let separator = match (at, has_number) {
                    (0, false) => "",
                    (0, true) => " ",
                    _ => ", ",
                };
                if matches!(value, FieldValue::Reals(_)) && !message.labels.is_empty() {
                    for (Label { name, unit }, value) in message.signals() {
                        let space = if unit.is_empty() { "" } else { " " };
                        write!(line, ", {name} {value}{space}{unit}")?;
                    }
                    continue;
                }
                write!(line, "{separator}{} {value}", field.name)?;
                if let Some(unit) = field.unit() {
                    // 57 x 0.1 us
                    let times = if unit.starts_with(|c: char| c.is_ascii_digit()) { "x " } else { "" };
                    write!(line, " {times}{unit}")?;
                }
            }
        }
        (Err(_), Some((kind, number))) => {
            write!(line, "{:<20}  ", "UNKNOWN")?;
            if let Some(number) = number {
                write!(line, "#{number} ")?;
            }
            write!(line, "kind {kind:#04x}: {:#}", Hex(&entry.bytes))?;
        }
        (Err(error), None) => {
            let shown = &entry.bytes[..entry.bytes.len().min(SHOWN)];
            let cut = if entry.bytes.len() > SHOWN { " ..." } else { "" };
            write!(line, "{:<20}  {error}: {:#}{cut}", "BAD", Hex(shown))?;
        }
    }
    Ok(())
}

/// The counters, after the last entry.
#[must_use]
pub fn counters(counters: &Counters) -> String {
    let Counters { messages, discarded_bytes, oversized, malformed, crc_errors, refused, unknown } = counters;
    let unknown = if *unknown == 0 { String::new() } else { format!(", {unknown} of unknown kinds") };
    format!(
        "{}{unknown}; bad: {crc_errors} by CRC, {malformed} malformed, {oversized} oversized, \
         {refused} refused ({})",
        counted((*messages).into(), "message"),
        counted((*discarded_bytes).into(), "byte")
    )
}
