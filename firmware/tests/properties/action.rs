//! What may happen to a drive, and the same as bytes for the fuzzer.
//!
//! ```text
//! 0 n bytes[n]                noise on the line
//! 1 k fields                  a message of the host, k modulo the number of kinds, in a good frame
//! 2 motor load reference      the next sample of the run: counts moved (i16), reference (f32)
//! 3 us                        time passes (u32)
//! 4 n                         bytes lost by the hardware
//! 5                           the line takes what the drive has to say
//! ```
//!
//! Numbers are little endian. Any bytes are a history: the first is taken modulo 6, and what is missing at the end
//! reads as zeros.

use std::time::Duration;

use lashloop_protocol::{HostMessage, Message};

/// One thing that happens to a drive.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Bytes as they come off a line, whole frames or not.
    Line(Vec<u8>),
    /// A body of any content in a good frame.
    Body(Vec<u8>),
    /// The next sample of the run, the encoders having moved by so many counts.
    Sample {
        /// Motor counts since the last one.
        motor: i16,
        /// Load counts since the last one.
        load: i16,
        /// In rad, any bits.
        reference_rad: f32,
    },
    /// Device time.
    Pass(Duration),
    /// Bytes that never came out of the hardware.
    Overruns(u8),
    /// The output goes out and is cleared.
    Drain,
}

impl Action {
    /// Reads one action off the front of `bytes`; `None` at their end.
    pub fn read(bytes: &mut &[u8]) -> Option<Self> {
        let (&tag, rest) = bytes.split_first()?;
        *bytes = rest;
        Some(match tag % 6 {
            0 => {
                let len = usize::from(u8::from_le_bytes(take(bytes)));
                let (line, rest) = bytes.split_at(len.min(bytes.len()));
                *bytes = rest;
                Self::Line(line.to_vec())
            }
            1 => {
                let [kind] = take(bytes);
                let layout = HostMessage::LAYOUTS[usize::from(kind) % HostMessage::LAYOUTS.len()];
                let mut body = vec![layout.kind];
                body.extend((1..layout.body_len).map(|_| u8::from_le_bytes(take(bytes))));
                Self::Body(body)
            }
            2 => Self::Sample {
                motor: i16::from_le_bytes(take(bytes)),
                load: i16::from_le_bytes(take(bytes)),
                reference_rad: f32::from_le_bytes(take(bytes)),
            },
            3 => Self::Pass(Duration::from_micros(u32::from_le_bytes(take(bytes)).into())),
            4 => Self::Overruns(u8::from_le_bytes(take(bytes))),
            _ => Self::Drain,
        })
    }
}

fn take<const N: usize>(bytes: &mut &[u8]) -> [u8; N] {
    let (now, rest) = bytes.split_at(N.min(bytes.len()));
    *bytes = rest;
    let mut taken = [0; N];
    taken[..now.len()].copy_from_slice(now);
    taken
}
