//! A drive written from `docs/protocol.md` alone: no code of the firmware. Its choices are another person's, where the page
//! leaves one: two laws, sixteen signals, a live parameter, an order of the parameters of its own.

mod arming;
mod clock;
mod description;
mod descriptions;
mod events;
mod fields;
mod incoming;
mod link;
mod options;
mod receiver;
mod requests;
mod run;
mod samples;
mod table;

use lashloop_protocol::enums::{FaultCode, LogLevel, ParameterValue, State};
use lashloop_protocol::message::{FaultReport, LineReport, Log};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, Message};

use crate::mutation::{Sites, Width};
use description::Table;
use options::Recording;
use receiver::Receiver;
use run::{Run, Values};

pub use description::{FINE, FIXED, REAL, SLOW};
pub use link::Specimen;

/// A kind that this version lacks, with a number.
const LATER_KIND: u8 = 0xe7;

/// What a drive is like besides its parameters.
#[derive(Clone, Copy)]
pub struct Character {
    /// Sends a log and a message of a later version after every other message, as the page allows.
    pub is_chatty: bool,
    /// Messages have a device time.
    pub has_clock: bool,
    /// Time between two looks at the watchdog.
    pub look_us: f64,
    /// Drops what follows the first frame of a write, which the page forbids.
    pub loses_bursts: bool,
    /// Stores parameters and captures signals.
    pub has_options: bool,
}

impl Character {
    pub const USUAL: Self =
        Self { is_chatty: false, has_clock: true, look_us: 1_000.0, loses_bursts: false, has_options: false };
}

/// The drive behind its receiver.
struct Drive {
    at: Sites,
    character: Character,
    now_us: f64,
    /// When the request being answered arrived.
    arrived_us: f64,
    receiver: Receiver,
    session: Option<u32>,
    /// Number of the request being answered; 0 for a sample.
    number: u8,
    values: Values,
    /// The stored parameters.
    stored: Option<Values>,
    recording: Option<Recording>,
    signals: u32,
    every: u16,
    fault: Option<FaultReport>,
    run: Option<Run>,
    /// When the watchdog was fed.
    fed_us: f64,
    polled_us: f64,
    /// When a mistaken drive repeats its report.
    repeated_us: f64,
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
    fn new(at: Sites, table: &'static Table, character: Character) -> Self {
        Self {
            at,
            character,
            now_us: 0.0,
            arrived_us: 0.0,
            receiver: Receiver::default(),
            session: None,
            number: 0,
            values: Values::defaults(table),
            stored: None,
            recording: None,
            signals: 0,
            every: 0,
            fault: None,
            run: None,
            fed_us: 0.0,
            polled_us: 0.0,
            repeated_us: 0.0,
            watches_in_boot: false,
            first_law: None,
            counts: NO_COUNTS,
            torque_nm: 0.0,
            output: Vec::new(),
            held: Vec::new(),
        }
    }

    fn defaults(&self) -> Values {
        self.stored.unwrap_or_else(|| Values::defaults(self.values.table))
    }

    fn state(&self) -> State {
        self.at.state.get()
    }

    fn set_state(&mut self, state: State) {
        if self.state() == State::Running && state != State::Running {
            self.capture_end(state == State::Faulted);
        }
        self.at.state.set(state);
    }

    /// Sends a message through the sites of its fields. A mutant loses it, doubles it, or sends it or a copy behind the next.
    fn send(&mut self, message: impl Into<DriveMessage>) {
        let message = self.timed(message.into());
        let layout = message.layout();
        let mut body = body_of(&message);
        if layout.has_number() {
            let number = (f64::from(self.number), Width::U8);
            body[1] = self.at.number_or("number", layout.name, number, Some(1.0)) as u8;
        }
        fields::through_sites(&self.at, layout, &mut body);
        let frame = receiver::frame(&self.at, &body);
        let held = std::mem::take(&mut self.held);
        let fates = [0, 1, 2, 3, 4];
        match self.at.pick(layout.name, "times sent, 3 for behind the next, 4 for again behind it", 1, &fates)
        {
            3 => self.held = frame,
            4 => {
                self.output.extend(&frame);
                self.held = frame;
            }
            copies => (0..copies).for_each(|_| self.output.extend(&frame)),
        }
        self.output.extend(held);
        if self.character.is_chatty && layout.name != "Log" {
            self.output.extend(receiver::frame(&self.at, &[LATER_KIND, 1, 2, 3]));
            let text = Text::new("a log at any time");
            self.send(Log { level: LogLevel::Warning, text, device_time_us: None });
        }
    }

    /// Latches a fault, unless there is one, and returns its report.
    fn trip(&mut self, code: FaultCode, value: f64, limit: f64) -> FaultReport {
        let sequence = self.run.as_ref().and_then(|run| run.last).unwrap_or(0);
        let (value, limit) = (value as f32, limit as f32);
        let report = FaultReport { code, sequence, value, limit, detail: 0, device_time_us: None };
        if self.fault.is_none() || !self.at.flag("fault", "the first one is kept", true) {
            self.fault = Some(report);
        }
        report
    }

    fn is_set(&self, index: usize) -> ParameterValue {
        self.values.set[index]
    }
}

const NO_COUNTS: LineReport =
    LineReport { messages: 0, damaged: 0, refused: 0, overruns: 0, device_time_us: None };

/// The body of a message, from the codec's frame.
fn body_of(message: &DriveMessage) -> Vec<u8> {
    let mut frame = message.frame().to_vec();
    lashloop_protocol::frame::open(frame.split_last_mut().expect("a delimiter").1)
        .expect("a good frame")
        .to_vec()
}
