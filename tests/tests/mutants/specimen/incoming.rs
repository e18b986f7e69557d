//! From the bytes of the line to requests.

use lashloop_protocol::enums::Outcome;
use lashloop_protocol::layout::has_number;
use lashloop_protocol::message::CommandResult;
use lashloop_protocol::{HostMessage, Message};

use super::{Drive, fields};

/// A whole body.
enum Incoming {
    Request(HostMessage),
    /// Of a kind that the drive does not know.
    Unknown(u8),
    Refused,
}

/// Kinds of the options that the specimen does not have.
const OPTIONS: [&str; 3] = ["Reference", "EnterLoader", "SetZero"];

impl Drive {
    /// Takes a byte from the line; true if it ended a frame.
    pub(super) fn take(&mut self, byte: u8) -> bool {
        let Some(frame) = self.receiver.take(&self.at, byte, self.now_us) else { return false };
        self.arrived_us = self.now_us;
        let Ok(mut body) = frame else {
            self.counts.damaged = self.counted(self.counts.damaged, "a damaged frame");
            self.after("a damaged frame");
            return true;
        };
        match self.incoming(&mut body) {
            Incoming::Request(request) => {
                self.counts.messages = self.counted(self.counts.messages, "a good message");
                self.handle(request);
            }
            Incoming::Unknown(kind) => {
                self.counts.messages = self.counted(self.counts.messages, "an unknown request");
                self.answer_unknown(kind);
                self.after("an unknown request");
            }
            Incoming::Refused => {
                self.counts.refused = self.counted(self.counts.refused, "a refused frame");
                self.after("a refused frame");
            }
        }
        true
    }

    /// A count with one more. A mistaken drive counts in 16 bits.
    fn counted(&self, count: u32, what: &'static str) -> u32 {
        let more = self.at.whole("line report", what, 1) as u32;
        let count = count.wrapping_add(more);
        if count > 0xffff && self.at.flag("line report in 16 bits", what, false) {
            count & 0xffff
        } else {
            count
        }
    }

    /// The request in a whole body.
    fn incoming(&mut self, body: &mut Vec<u8>) -> Incoming {
        let Some(&kind) = body.first() else { return Incoming::Refused };
        let known =
            || HostMessage::LAYOUTS.iter().filter(|it| !OPTIONS.contains(&it.name) && self.knows(it.name));
        let layout = known().find(|it| it.kind == kind);
        let masked = known().find(|it| it.kind == kind & 0x7f);
        self.number = if has_number(kind) { body.get(1).copied().unwrap_or(0) } else { 0 };
        if layout.is_none() && (1..0x80).contains(&kind) {
            let is_known = self.at.flag("receiver", "an unknown kind counts apart from refused ones", true);
            return if is_known { Incoming::Unknown(kind) } else { Incoming::Refused };
        }
        // A mistaken drive looks at the low bits of a kind alone.
        if layout.is_none() && self.at.flag("receiver", "a kind of the other direction is refused", true) {
            return Incoming::Refused;
        }
        let Some(layout) = layout.or(masked) else {
            return Incoming::Refused;
        };
        body[0] = layout.kind;
        if body.len() > layout.body_len && self.at.flag("receiver", "a longer body is refused", false) {
            return Incoming::Refused;
        }
        if self.at.flag("receiver", "a body too short is refused", body.len() < layout.body_len) {
            return Incoming::Refused;
        }
        body.resize(layout.body_len, 0);
        if has_number(kind) {
            self.number = body[1];
        }
        fields::through_sites(&self.at, layout, body);
        match HostMessage::decode_body(body) {
            Ok(request) => Incoming::Request(request.message),
            Err(_) if self.at.flag("receiver", "a value outside its type is refused", true) => {
                Incoming::Refused
            }
            Err(_) => {
                body[3] = 1;
                HostMessage::decode_body(body)
                    .map_or(Incoming::Refused, |request| Incoming::Request(request.message))
            }
        }
    }

    fn answer_unknown(&mut self, kind: u8) {
        let is_answered = self.at.flag("unknown request", "is answered", has_number(kind));
        let outcome = self.at.pick("unknown request", "outcome", Outcome::UnknownRequest, Outcome::ALL);
        if is_answered {
            let (state, detail) = (self.state(), 0);
            self.send(CommandResult { request: kind, outcome, state, detail, device_time_us: None });
        }
    }
}
