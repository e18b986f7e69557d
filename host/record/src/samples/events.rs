//! Messages of `/fault` and `/log`: what happened besides the steps.

use lashloop_bench::fault::timeline::FaultEdge;
use lashloop_bench::run::Event;

pub(super) const FAULT_SCHEMA: &str =
    "string kind\nuint32 number # in the scenario, from 0\nuint8 begins # 0 at its end\n";
pub(super) const LOG_SCHEMA: &str = "string text\n";

/// Begin or end of an injected fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedEdge {
    /// Its step.
    pub step: u64,
    /// Name of the kind.
    pub kind: String,
    /// Number of the fault in the scenario, from 0.
    pub number: u32,
    /// Begin or end.
    pub begins: bool,
}

/// A text of the drive, or of the bench about the drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedText {
    /// Step in which the drive formed it, in real time and by a drive with a clock; else that of its arrival. Texts from before
    /// the run have step 0.
    pub step: u64,
    /// The text, behind its level.
    pub text: String,
}

/// Appends the message of an event.
pub(super) fn encode(event: &Event, message: &mut Vec<u8>) {
    match event {
        Event::Fault(FaultEdge { number, kind, begins, .. }) => {
            push_text(kind, message);
            message.extend_from_slice(&(*number as u32).to_le_bytes());
            message.push(u8::from(*begins));
        }
        Event::Log(entry) => push_text(&entry.to_string(), message),
    }
}

/// An edge of a message; `None` for another layout.
pub(super) fn edge(step: u64, message: &[u8]) -> Option<RecordedEdge> {
    let (kind, rest) = take_text(message)?;
    let (number, rest) = rest.split_first_chunk()?;
    let [begins] = rest else { return None };
    Some(RecordedEdge { step, kind, number: u32::from_le_bytes(*number), begins: *begins != 0 })
}

/// A text of a message.
pub(super) fn text(step: u64, message: &[u8]) -> Option<RecordedText> {
    take_text(message).map(|(text, _)| RecordedText { step, text })
}

/// A text as ROS packs it: its length, then its bytes.
fn push_text(text: &str, bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&(text.len() as u32).to_le_bytes());
    bytes.extend_from_slice(text.as_bytes());
}

fn take_text(bytes: &[u8]) -> Option<(String, &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    let (text, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    Some((String::from_utf8_lossy(text).into_owned(), rest))
}
