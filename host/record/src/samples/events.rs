//! Messages of `/fault` and `/log`: what happened besides the steps.

use lashloop_bench::fault::timeline::FaultEdge;
use lashloop_bench::run::Event;

use super::packing::{Packing, Unpacker, begin, push, push_text};

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

/// Writes an event to `message`.
pub(super) fn encode(event: &Event, message: &mut Vec<u8>) {
    begin(message);
    match event {
        Event::Fault(FaultEdge { number, kind, begins, .. }) => {
            push_text(kind, message);
            push((*number as u32).to_le_bytes(), message);
            push([u8::from(*begins)], message);
        }
        Event::Log(entry) => push_text(&entry.to_string(), message),
    }
}

/// An edge of a message; `None` for another layout.
pub(super) fn edge(step: u64, packing: Packing, message: &[u8]) -> Option<RecordedEdge> {
    let mut message = Unpacker::new(packing, message)?;
    let (kind, number, [begins]) = (message.text()?, u32::from_le_bytes(message.take()?), message.take()?);
    Some(RecordedEdge { step, kind, number, begins: begins != 0 })
}

/// A text of a message.
pub(super) fn text(step: u64, packing: Packing, message: &[u8]) -> Option<RecordedText> {
    Some(RecordedText { step, text: Unpacker::new(packing, message)?.text()? })
}
