//! The probable cause of a missing answer, and its remedy.

use std::fmt;

use lashloop_protocol::enums::FaultCode;

use super::arrivals::Arrivals;
use super::bad_frame::{CrcVariant, Refusal};
use super::echoed::OtherIndex;
use super::framing::FramingMistake;

/// Rate of messages that no request causes from which answers wait behind them.
const FLOOD_PER_S: f64 = 500.0;
/// Bytes without a delimiter from which chance doesn't explain it: one random byte in 256 is a delimiter.
const ENDLESS: u64 = 2048;

/// The probable cause of a missing answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Cause {
    /// Nothing has ever arrived from a drive, and nothing arrived now.
    NoDrive,
    /// A drive that answered before is silent.
    Hang,
    /// A drive is silent after it has reported a fault.
    Halted {
        /// The fault.
        code: FaultCode,
        /// Its detail.
        detail: u32,
    },
    /// A drive sends logs, and has never answered.
    Deaf,
    /// The bench's own frames come back.
    Loopback,
    /// A terminal in cooked mode echoes the bench's bytes.
    CookedEcho,
    /// The far end sends requests, as a host does.
    HostAtFarEnd {
        /// Name of its last request.
        request: &'static str,
    },
    /// Answers arrive to requests that this bench has not sent.
    SecondHost,
    /// A whole frame isn't a message of a drive.
    Refused(Refusal),
    /// `Identity` of another session.
    OtherSession {
        /// The session received.
        received: u32,
        /// The session of the `Hello`.
        sent: u32,
    },
    /// Messages that no request causes arrive faster than a bench needs them.
    Flood,
    /// Answers arrive with another number than that of the request.
    OtherNumber {
        /// The number received.
        received: u8,
        /// The number of the request.
        sent: u8,
    },
    /// Answers arrive with the number of the request and another index.
    OtherIndex(OtherIndex),
    /// A part of the answer arrives, without its end.
    PartAnswer {
        /// Name of the message.
        part: &'static str,
    },
    /// Good frames arrive, without the awaited one among them.
    OtherAnswers,
    /// Bytes arrive one by one, slower than any line.
    Trickle,
    /// The firmware computes another CRC.
    Crc(CrcVariant),
    /// The firmware frames its messages wrongly.
    Framing(FramingMistake),
    /// The far end sends text: its first line, escaped.
    Text(String),
    /// Delimiters alone.
    ZeroBytes,
    /// Bytes without a delimiter.
    EndlessFrame,
    /// The beginning of a frame, of a drive that answered before.
    Unfinished,
    /// The far end sends at a lower baud rate.
    LowerBaud,
    /// Bytes that aren't frames.
    NoFrames,
    /// Frames of a drive that answered before are damaged.
    Damage,
}

impl Cause {
    /// The cause that explains `arrivals` best. `is_connected`: an awaited frame has arrived on this line before.
    pub(super) fn of(arrivals: &Arrivals, is_connected: bool) -> Self {
        let silent = || if is_connected { Self::Hang } else { Self::NoDrive };
        let Arrivals { raw, .. } = arrivals;
        let good = arrivals.good_count();
        if arrivals.bytes == 0 {
            return silent();
        }
        if good == 0 && arrivals.refused == 0 && arrivals.own_frames > 0 {
            return if is_connected { Self::Hang } else { Self::Loopback };
        }
        if let Some(request) = arrivals.host_request {
            return Self::HostAtFarEnd { request };
        }
        if let Some(refusal) = arrivals.refusal.filter(Refusal::is_identity) {
            return Self::Refused(refusal);
        }
        if let Some((received, sent)) = arrivals.other_session {
            return Self::OtherSession { received, sent };
        }
        if arrivals.trickles() && !raw.is_text() {
            return Self::Trickle;
        }
        if arrivals.unsolicited_per_s() > FLOOD_PER_S {
            return Self::Flood;
        }
        if good > 0 {
            return Self::of_good_frames(arrivals, is_connected);
        }
        if let Some(refusal) = arrivals.refusal {
            return Self::Refused(refusal);
        }
        if let Some(variant) = arrivals.crc_variant {
            return Self::Crc(variant);
        }
        if let Some(mistake) = FramingMistake::of(raw.framed(), is_connected) {
            return Self::Framing(mistake);
        }
        let has_no_end = arrivals.damaged() == 0;
        match raw {
            raw if raw.count == 0 => Self::ZeroBytes,
            raw if raw.is_cooked_echo() => Self::CookedEcho,
            raw if raw.is_text() => Self::Text(raw.first_line()),
            raw if has_no_end && raw.count >= ENDLESS => Self::EndlessFrame,
            _ if has_no_end && is_connected => Self::Unfinished,
            _ if is_connected => Self::Damage,
            raw if raw.is_sampled_too_fast() => Self::LowerBaud,
            _ => Self::NoFrames,
        }
    }

    /// As [`Self::of`], if good frames have arrived and none is the answer.
    fn of_good_frames(arrivals: &Arrivals, is_connected: bool) -> Self {
        let good = arrivals.good_count();
        if good == arrivals.unsolicited() {
            return match arrivals.fault {
                Some((code, detail)) => Self::Halted { code, detail },
                // Logs, and the telemetry of the last sample.
                None if is_connected => Self::Hang,
                None => Self::Deaf,
            };
        }
        let is_foreign = 2 * u64::from(arrivals.unrequested) > u64::from(good);
        match *arrivals {
            _ if is_foreign => Self::SecondHost,
            Arrivals { other_index: Some(other), .. } => Self::OtherIndex(other),
            Arrivals { part: Some(part), .. } => Self::PartAnswer { part },
            Arrivals { other_number: Some((received, sent)), .. } => Self::OtherNumber { received, sent },
            _ => Self::OtherAnswers,
        }
    }
}

/// The cause and what to do about it.
impl fmt::Display for Cause {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDrive => out.write_str(
                "no drive, no power, or another port or baud rate; check the power, the cable (TX to RX), the port and the \
                 baud rate",
            ),
            Self::Hang => out.write_str("the firmware hangs or the line is cut; check the power and the cable"),
            Self::Halted { code: FaultCode::Panic, detail } => write!(
                out,
                "the firmware panicked at source line {detail} and has halted; correct it, then power the drive off and on"
            ),
            Self::Halted { code: FaultCode::ProcessorFault, detail } => write!(
                out,
                "the processor took a fault at {detail:#010x}, or an interrupt of that number, and has halted; correct the \
                 firmware, then power the drive off and on"
            ),
            Self::Halted { code, .. } => write!(
                out,
                "the drive reports the fault {code} and nothing after it: the firmware hangs in its reaction; check it, then power \
                 the drive off and on"
            ),
            Self::Deaf => out.write_str(
                "the drive sends of its own accord and answers nothing, so it receives nothing; check the wire from the bench's TX \
                 to the drive's RX, and the firmware's receiver",
            ),
            Self::Loopback => out.write_str(
                "the far end returns the bench's own frames, as a loop plug, an echo or a second open port does; connect RX \
                 to the drive's TX and switch the echo off",
            ),
            Self::CookedEcho => out.write_str(
                "a terminal in cooked mode echoes the bench's bytes (^@ for a delimiter); put the drive's terminal into raw \
                 mode: stty raw -echo",
            ),
            Self::HostAtFarEnd { request } => write!(
                out,
                "the far end sends {request}, a request of a host; connect one bench to one drive"
            ),
            Self::SecondHost => out.write_str(
                "a second host uses this drive, or the drive sends answers without a request; disconnect every other program",
            ),
            Self::Refused(refusal) => {
                write!(out, "the drive sends {refusal}; correct the firmware, or use the bench of its version")
            }
            Self::OtherSession { received, sent } => {
                write!(out, "Identity has session {received:#010x}, Hello had {sent:#010x}; ")?;
                out.write_str(if received.swap_bytes() == *sent {
                    "the firmware reverses the bytes of session: numbers are little endian"
                } else {
                    "the firmware must return the session of Hello, or a second host uses this drive"
                })
            }
            Self::Flood => out.write_str(
                "answers wait behind messages that no request causes; the firmware must answer first and send fewer of them",
            ),
            Self::OtherNumber { received, sent } => write!(
                out,
                "answers have the number {received}, the request has {sent}; the firmware must repeat the number of each request, or \
                 a delay on the line is longer than the wait"
            ),
            Self::OtherIndex(OtherIndex { answer, field, received, sent }) => write!(
                out,
                "{} has {field} {received}, the request has {sent}; the firmware must repeat the {field} of the request",
                answer.name
            ),
            Self::PartAnswer { part } => write!(
                out,
                "{part} belongs to the answer and its end is missing; the firmware must send all messages of an answer"
            ),
            Self::OtherAnswers => {
                out.write_str(
                    "answers to other requests, so the drive omits this one, or a delay on the line is longer than the wait; \
                     check the firmware and the line",
                )
            }
            Self::Trickle => out.write_str(
                "single bytes with pauses, so an answer takes longer than the limit; send each frame in one write, and check \
                 converters on the line for delays",
            ),
            Self::Crc(variant) => write!(out, "whole frames have a wrong CRC: {variant}"),
            Self::Framing(mistake) => mistake.fmt(out),
            Self::Text(line) => write!(
                out,
                "the far end sends text, \"{line}\": a console, a modem or a boot loader instead of a drive; take another \
                 port, or silence the console on this one"
            ),
            Self::ZeroBytes => out.write_str(
                "zero bytes alone: the line is held low (break, a transceiver without power), or the far end sends at a much \
                 lower baud rate; check the cable and the power of the drive",
            ),
            Self::EndlessFrame => out.write_str(
                "no byte is zero, so no frame ends; the firmware must end each frame with a zero byte, or this is another \
                 protocol",
            ),
            Self::Unfinished => out.write_str(
                "a frame begins and does not end: the firmware hangs while it sends, or forgets the delimiter; check it, and the \
                 power of the drive",
            ),
            Self::LowerBaud => out.write_str(
                "bytes of long equal bits, so the far end sends at a lower baud rate; set the same rate on both sides",
            ),
            Self::NoFrames => out.write_str(
                "no frame of a drive: another baud rate, another protocol, or noise on an open input; check --baud, the \
                 ground and the far end",
            ),
            Self::Damage => out.write_str(
                "the line damages frames, or a second program reads it; check the ground and the cable, or lower the baud \
                 rate on both sides",
            ),
        }
    }
}
