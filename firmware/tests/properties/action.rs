//! Actions on a drive, and their encoding as bytes for the fuzzer.
//!
//! ```text
//! 0 n bytes[n]                bytes on the line
//! 1 k number fields           a host message in a valid frame, k modulo the number of kinds
//! 2 motor load reference      the next sample of the run: moved counts (i16), reference (f32)
//! 3 us                        device time elapses (u32)
//! 4 n                         bytes lost by the hardware
//! 5                           the output is transmitted
//! 6 s                         a reset, then the shortest way to a state, s modulo the number of states
//! ```
//!
//! Numbers are little endian. Any bytes are a history: tags count modulo 7, and bytes missing at the end read as zero.

use std::borrow::Cow;
use std::time::Duration;

use lashloop_protocol::enums::State;
use lashloop_protocol::frame::MAX_BODY;
use lashloop_protocol::{HostMessage, Message};

/// A body, without an allocation: a fuzzer executes millions of histories.
pub type Body = heapless::Vec<u8, MAX_BODY>;

/// One action on a drive.
#[derive(Clone, Debug, PartialEq)]
pub enum Action<'bytes> {
    /// Received bytes, whole frames or not.
    Line(Cow<'bytes, [u8]>),
    /// Any body in a valid frame.
    Body(Body),
    /// The next sample of the run.
    Sample {
        /// Motor counts since the last sample.
        motor: i16,
        /// Load counts since the last sample.
        load: i16,
        /// Reference in rad, any bits.
        reference_rad: f32,
    },
    /// Device time elapses; the drive ticks.
    Elapse(Duration),
    /// The hardware loses this number of bytes.
    Overruns(u8),
    /// The output is transmitted and cleared.
    Drain,
    /// A reset and the requests that lead to the state.
    Enter(State),
}

impl<'bytes> Action<'bytes> {
    /// Decodes one action from the front of `bytes`; `None` at their end.
    pub fn read(bytes: &mut &'bytes [u8]) -> Option<Self> {
        let (&tag, rest) = bytes.split_first()?;
        *bytes = rest;
        Some(match tag % 7 {
            0 => {
                let len = usize::from(u8::from_le_bytes(take(bytes)));
                let (line, rest) = bytes.split_at(len.min(bytes.len()));
                *bytes = rest;
                Self::Line(line.into())
            }
            1 => {
                let [kind] = take(bytes);
                let layout = HostMessage::LAYOUTS[usize::from(kind) % HostMessage::LAYOUTS.len()];
                let fields = (1..layout.body_len).map(|_| u8::from_le_bytes(take(bytes)));
                Self::Body([layout.kind].into_iter().chain(fields).collect())
            }
            2 => Self::Sample {
                motor: i16::from_le_bytes(take(bytes)),
                load: i16::from_le_bytes(take(bytes)),
                reference_rad: f32::from_le_bytes(take(bytes)),
            },
            3 => Self::Elapse(Duration::from_micros(u32::from_le_bytes(take(bytes)).into())),
            4 => Self::Overruns(u8::from_le_bytes(take(bytes))),
            5 => Self::Drain,
            _ => {
                let [state] = take(bytes);
                Self::Enter(State::ALL[usize::from(state) % State::ALL.len()])
            }
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
