//! The probable cause of a missing answer, and its remedy.

use std::fmt;

use super::arrivals::Arrivals;
use super::bad_frame::{CrcVariant, Refusal};

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
    /// Good frames arrive, without the awaited one among them.
    OtherAnswers,
    /// Bytes arrive one by one, slower than any line.
    Trickle,
    /// The firmware computes another CRC.
    Crc(CrcVariant),
    /// The far end sends text: its first line, escaped.
    Text(String),
    /// Delimiters alone.
    ZeroBytes,
    /// Bytes without a delimiter.
    EndlessFrame,
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
        // Logs, and the telemetry of the last sample.
        if is_connected && good > 0 && good == arrivals.unsolicited() {
            return Self::Hang;
        }
        if good > 0 {
            let is_foreign = 2 * u64::from(arrivals.unrequested) > u64::from(good);
            return if is_foreign { Self::SecondHost } else { Self::OtherAnswers };
        }
        if let Some(refusal) = arrivals.refusal {
            return Self::Refused(refusal);
        }
        match arrivals.crc_variant {
            Some(variant) => Self::Crc(variant),
            None if raw.count == 0 => Self::ZeroBytes,
            None if raw.is_cooked_echo() => Self::CookedEcho,
            None if raw.is_text() => Self::Text(raw.first_line()),
            None if arrivals.damaged() == 0 && raw.count >= ENDLESS => Self::EndlessFrame,
            None if is_connected => Self::Damage,
            None if raw.is_sampled_too_fast() => Self::LowerBaud,
            None => Self::NoFrames,
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
