//! A drive written from `docs/protocol.md` alone: no code of the firmware. Its choices are another person's, where the page
//! leaves one: two laws, sixteen signals, a live parameter, an order of the parameters of its own.

mod description;
mod descriptions;
mod events;
mod fields;
mod link;
mod receiver;
mod requests;
mod run;
mod samples;
mod table;

use lashloop_protocol::enums::{FaultCode, LogLevel, ParameterValue, State};
use lashloop_protocol::message::{FaultReport, LineReport, Log};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use crate::mutation::{Sites, Width};
use description::Table;
use receiver::Receiver;
use run::{Run, Values};

pub use description::{FINE, FIXED, REAL, SLOW};
pub use link::Specimen;

/// A kind that this version lacks.
const LATER_KIND: u8 = 0xf7;
/// Time between two looks at the watchdog.
const LOOK_US: f64 = 1_000.0;

/// The drive behind its receiver.
struct Drive {
    at: Sites,
    now_us: f64,
    /// When the request being answered arrived.
    arrived_us: f64,
    receiver: Receiver,
    session: Option<u32>,
    values: Values,
    /// Sends a log and a message of a later version after every other message, as the page allows.
    is_chatty: bool,
    signals: u32,
    every: u16,
    fault: Option<FaultReport>,
    run: Option<Run>,
    /// When the watchdog was fed.
    fed_us: f64,
    polled_us: f64,
    /// A mistaken drive leaves the watchdog on after a `Reset`.
    watches_in_boot: bool,
    /// The law of the first `Arm`, by which a mistaken drive goes forever.
    first_law: Option<u32>,
    counts: LineReport,
    /// The torque of the last step, which a mistaken drive keeps.
    torque_nm: f32,
    output: Vec<u8>,
    /// A frame that a mistaken drive sends behind the next one.
    held: Vec<u8>,
}

impl Drive {
    fn new(at: Sites, table: &'static Table, is_chatty: bool) -> Self {
        Self {
            at,
            now_us: 0.0,
            arrived_us: 0.0,
            receiver: Receiver::default(),
            session: None,
            values: Values::defaults(table),
            is_chatty,
            signals: 0,
            every: 0,
            fault: None,
            run: None,
            fed_us: 0.0,
            polled_us: 0.0,
            watches_in_boot: false,
            first_law: None,
            counts: LineReport { messages: 0, damaged: 0, refused: 0, overruns: 0 },
            torque_nm: 0.0,
            output: Vec::new(),
            held: Vec::new(),
        }
    }

    fn defaults(&self) -> Values {
        Values::defaults(self.values.table)
    }

    fn state(&self) -> State {
        self.at.state.get()
    }

    fn set_state(&mut self, state: State) {
        self.at.state.set(state);
    }

    /// Takes a byte from the line; true if it ended a frame.
    fn take(&mut self, byte: u8) -> bool {
        let Some(frame) = self.receiver.take(&self.at, byte, self.now_us) else { return false };
        self.arrived_us = self.now_us;
        let Ok(mut body) = frame else {
            self.counts.damaged =
                self.counts.damaged.wrapping_add(self.at.whole("line report", "a damaged frame", 1) as u32);
            self.after("a damaged frame");
            return true;
        };
        match self.request_of(&mut body) {
            Some(request) => {
                self.counts.messages =
                    self.counts
                        .messages
                        .wrapping_add(self.at.whole("line report", "a good message", 1) as u32);
                self.handle(request);
            }
            None => {
                self.counts.refused =
                    self.counts
                        .refused
                        .wrapping_add(self.at.whole("line report", "a refused frame", 1) as u32);
                self.after("a refused frame");
            }
        }
        true
    }

    /// The request in a whole body, unless it is refused.
    fn request_of(&mut self, body: &mut Vec<u8>) -> Option<HostMessage> {
        let kind = *body.first()?;
        // The specimen has no pins and no boot loader: it refuses their messages as of an unknown kind.
        let known =
            || HostMessage::LAYOUTS.iter().filter(|it| !["Reference", "EnterLoader"].contains(&it.name));
        let layout = known().find(|it| it.kind == kind);
        // A mistaken drive looks at the low bits of a kind alone.
        if layout.is_none() && self.at.flag("receiver", "a kind of the other direction is refused", true) {
            return None;
        }
        let layout = layout.or_else(|| known().find(|it| it.kind == kind & 0x7f))?;
        body[0] = layout.kind;
        if self.at.flag("receiver", "a body too long is refused", body.len() > layout.body_len) {
            return None;
        }
        if self.at.flag("receiver", "a body too short is refused", body.len() < layout.body_len) {
            return None;
        }
        body.resize(layout.body_len, 0);
        fields::through_sites(&self.at, layout, body);
        match HostMessage::decode_body(body) {
            Ok(request) => Some(request),
            Err(_) if self.at.flag("receiver", "a value outside its type is refused", true) => None,
            Err(_) => {
                body[2] = 1;
                HostMessage::decode_body(body).ok()
            }
        }
    }

    /// Sends a message through the sites of its fields. A mutant loses it, doubles it or sends it behind the next.
    fn send(&mut self, message: impl Into<DriveMessage>) {
        let message = message.into();
        let layout = message.layout();
        let mut body = body_of(&message);
        fields::through_sites(&self.at, layout, &mut body);
        let frame = receiver::frame(&self.at, &body);
        let held = std::mem::take(&mut self.held);
        let copies = self.at.pick(layout.name, "times sent, or 3 for behind the next", 1, &[0, 1, 2, 3]);
        match copies {
            3 => self.held = frame,
            copies => (0..copies).for_each(|_| self.output.extend(&frame)),
        }
        self.output.extend(held);
        if self.is_chatty && layout.name != "Log" {
            self.output.extend(receiver::frame(&self.at, &[LATER_KIND, 1, 2, 3]));
            self.log("a log at any time");
        }
    }

    fn log(&mut self, text: &str) {
        self.send(Log { level: LogLevel::Warning, text: Text::new(text) });
    }

    /// Latches a fault, unless there is one, and returns its report.
    fn trip(&mut self, code: FaultCode, value: f64, limit: f64) -> FaultReport {
        let sequence = self.run.as_ref().and_then(|run| run.last).unwrap_or(0);
        let report = FaultReport { code, sequence, value: value as f32, limit: limit as f32, detail: 0 };
        if self.fault.is_none() || !self.at.flag("fault", "the first one is kept", true) {
            self.fault = Some(report);
        }
        report
    }

    fn is_set(&self, index: usize) -> ParameterValue {
        self.values.set[index]
    }

    /// Looks at the watchdog; its report if it trips.
    fn watchdog(&mut self) -> Option<FaultReport> {
        let runs = self.at.flag("watchdog", "runs", self.state() == State::Running);
        let has_run = self.run.as_ref().is_some_and(|run| run.last.is_some());
        let runs_on = match self.state() {
            State::Armed => has_run && self.at.flag("watchdog", "runs on in Armed after a run", false),
            State::Boot => self.watches_in_boot,
            _ => false,
        };
        if !runs && !runs_on {
            return None;
        }
        let silence_us = self.now_us - self.fed_us;
        let limit_us = match &self.run {
            Some(run) => run.watchdog_us(&self.at),
            None => run::setting(&self.at, &self.values, description::WATCHDOG),
        };
        let reported_us = limit_us;
        let limit_us = self.at.real("watchdog", "limit", limit_us);
        let is_late = silence_us > limit_us
            || self.at.flag("watchdog", "trips at its limit", false) && silence_us == limit_us;
        if !self.at.flag("watchdog", "is late", is_late) {
            return None;
        }
        let code = self.at.fault("watchdog", FaultCode::Watchdog);
        let limit_s = reported_us * 1e-6;
        let silence = (silence_us * 1e-6, Width::Real);
        let silence_s = self.at.number_or("watchdog", "silence", silence, Some(limit_s));
        let report = self.trip(code, silence_s, limit_s);
        let state = self.at.state("watchdog", "state afterwards", State::Faulted);
        self.set_state(state);
        Some(report)
    }

    /// Lets time pass, with a look at the watchdog every millisecond.
    fn pass_until(&mut self, until_us: f64) {
        while self.now_us < until_us {
            let is_running = self.state() == State::Running;
            let between_us = if is_running {
                self.at.real("watchdog", "time between two looks", LOOK_US)
            } else {
                LOOK_US
            };
            let next_us = self.polled_us + between_us.max(100.0);
            self.now_us = next_us.min(until_us).max(self.now_us);
            if self.now_us < next_us {
                return;
            }
            self.polled_us = self.now_us;
            if let Some(report) = self.watchdog() {
                self.send(report);
            }
            self.after("a millisecond");
            if !self.output.is_empty() {
                return;
            }
        }
    }
}

/// The body of a message, from the codec's frame.
fn body_of(message: &DriveMessage) -> Vec<u8> {
    let mut frame = message.frame().to_vec();
    lashloop_protocol::frame::open(frame.split_last_mut().expect("a delimiter").1)
        .expect("a good frame")
        .to_vec()
}
