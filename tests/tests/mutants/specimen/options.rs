//! Stored parameters and captures, for a specimen that has them.

use lashloop_protocol::TelemetryValues;
use lashloop_protocol::enums::{Capabilities, CaptureTrigger, Outcome, State};
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;
use lashloop_protocol::message::{Capture, CaptureRows};
use lashloop_protocol::{HostMessage, Message};

use super::Drive;
use super::description::{PARAMETER_COUNT, SIGNALS};
use super::run::Values;

/// Most signals of a capture.
const MOST_SIGNALS: u32 = 4;
/// Values that the memory holds: fewer rows of more signals.
const HELD_VALUES: usize = 24;
/// Names of what a drive without these options has not.
const NAMES: [&str; 8] = [
    "StoreParameters",
    "RecallParameters",
    "ForgetParameters",
    "Capture",
    "ReadCapture",
    "CaptureRows",
    "StoreFailed",
    "NotCaptured",
];

/// The capture of a drive.
pub struct Recording {
    wanted: Capture,
    rows: Vec<Vec<f32>>,
    /// Number of its row.
    event: Option<usize>,
    is_complete: bool,
    /// Value of the trigger's signal in the row before.
    last: Option<f32>,
}

impl Drive {
    /// Whether the specimen has what has this name, as far as these options go.
    pub(super) fn knows(&self, name: &str) -> bool {
        self.character.has_options || !NAMES.contains(&name)
    }

    pub(super) fn options(&self) -> Capabilities {
        let both = Capabilities::STORE | Capabilities::CAPTURE;
        if self.character.has_options { both } else { Capabilities::empty() }
    }

    /// Handles a request of these options; false for another one.
    pub(super) fn option(&mut self, request: &HostMessage) -> bool {
        match request {
            HostMessage::StoreParameters(_)
            | HostMessage::RecallParameters(_)
            | HostMessage::ForgetParameters(_) => {
                let name = request.layout().name;
                let is_refused = self.at.flag(name, "is for Idle alone", self.state() != State::Idle);
                if !is_refused {
                    self.store(request);
                }
                self.result(request, if is_refused { Outcome::WrongState } else { Outcome::Accepted });
            }
            HostMessage::Capture(wanted) => self.capture(request, *wanted),
            HostMessage::ReadCapture(read) => self.read_capture(request, read.first),
            _ => return false,
        }
        true
    }

    fn store(&mut self, request: &HostMessage) {
        let does = |what| self.at.flag(request.layout().name, what, true);
        match request {
            HostMessage::StoreParameters(_) if does("is done") => {
                let mut stored = self.values;
                if !does("stores the last parameter") {
                    stored.set[PARAMETER_COUNT - 1] = self.defaults().set[PARAMETER_COUNT - 1];
                }
                self.stored = Some(stored);
            }
            HostMessage::RecallParameters(_) if does("is done") => {
                let own = Values::defaults(self.values.table);
                self.values = if does("takes the stored ones") { self.defaults() } else { own };
            }
            HostMessage::ForgetParameters(_) => {
                if does("forgets") {
                    self.stored = None;
                }
                if does("sets the parameters") {
                    self.values = self.defaults();
                }
            }
            _ => {}
        }
    }

    fn capture(&mut self, request: &HostMessage, wanted: Capture) {
        let Capture { signals, every, before, trigger, trigger_signal, level } = wanted;
        let held = HELD_VALUES / (signals.count_ones() as usize).max(1);
        let is_of_level = matches!(trigger, CaptureTrigger::Rising | CaptureTrigger::Falling);
        let is_captured = signals.checked_shr(trigger_signal.into()).is_some_and(|it| it & 1 == 1);
        let lacked = self.lacked(signals);
        let when = |refuses: bool, outcome| refuses.then_some(outcome);
        let has_signals = signals != 0;
        let refusal = self.refusal(
            "Capture",
            ["before the state", "before a bit without a signal", "before too many", "", "", "", "", ""],
            [
                (
                    "refused for the state",
                    when(matches!(self.state(), State::Boot | State::Faulted), Outcome::WrongState),
                ),
                ("a bit without a signal", when(signals >> SIGNALS.len() != 0, Outcome::UnknownIndex)),
                ("too many", when(signals.count_ones() > MOST_SIGNALS, Outcome::OutOfRange)),
                (
                    "its rows",
                    when(has_signals && (every == 0 || usize::from(before) >= held), Outcome::OutOfRange),
                ),
                ("its trigger", when(has_signals && !trigger.is_named(), Outcome::OutOfRange)),
                (
                    "a signal that isn't captured",
                    when(has_signals && is_of_level && !is_captured, Outcome::UnknownIndex),
                ),
                (
                    "a level that isn't finite",
                    when(has_signals && is_of_level && !level.is_finite(), Outcome::OutOfRange),
                ),
                ("a signal that the law lacks", lacked.map(|_| Outcome::SignalOfOtherLaw)),
            ],
        );
        let keeps = refusal.is_some() && self.at.flag("Capture", "refused changes nothing", true);
        if !keeps {
            let new = Recording { wanted, rows: vec![], event: None, is_complete: false, last: None };
            self.recording =
                (has_signals || !self.at.flag("Capture", "without signals ends it", true)).then_some(new);
        }
        let detail = lacked.filter(|_| refusal == Some(Outcome::SignalOfOtherLaw)).unwrap_or(0);
        self.result_with(request, refusal.unwrap_or(Outcome::Accepted), detail as u32);
    }

    /// After a control step: a row, if one is due.
    pub(super) fn capture_step(&mut self, signals: &[f32; SIGNALS.len()]) {
        let Some(mut it) = self.recording.take() else { return };
        let step = self.run.as_ref().map_or(0, |run| run.steps.wrapping_sub(1));
        let every = it.wanted.every.max(1);
        let is_due = self.at.flag("capture", "a row is due", step.is_multiple_of(every));
        if step == 0 {
            it.last = None;
        }
        if is_due && !it.is_complete {
            self.record(&mut it, signals);
        }
        self.recording = Some(it);
    }

    fn record(&self, it: &mut Recording, signals: &[f32; SIGNALS.len()]) {
        let Capture { signals: wanted, before, trigger, trigger_signal, level, .. } = it.wanted;
        let row: Vec<_> =
            (0..SIGNALS.len()).filter(|at| wanted >> at & 1 == 1).map(|at| signals[at]).collect();
        let held = HELD_VALUES / row.len().max(1);
        let before = usize::from(before);
        let value = signals.get(usize::from(trigger_signal)).copied().unwrap_or(0.0);
        let last = it.last.replace(value);
        if it.event.is_none() {
            let passes = |sign: f32| {
                last.is_some_and(|last| sign * last < sign * level) && sign * value >= sign * level
            };
            let is_event = match trigger {
                CaptureTrigger::Rising => self.at.flag("capture", "rising", passes(1.0)),
                CaptureTrigger::Falling => self.at.flag("capture", "falling", passes(-1.0)),
                CaptureTrigger::Fault => false,
                _ => it.rows.len() >= before,
            };
            if is_event {
                it.event = Some(it.rows.len());
            } else if it.rows.len() >= before && self.at.flag("capture", "keeps the last rows", true) {
                it.rows.push(row);
                it.rows.remove(0);
                return;
            }
        }
        it.rows.push(row);
        it.is_complete = it.rows.len() >= held;
    }

    /// At the end of a run.
    pub(super) fn capture_end(&mut self, is_fault: bool) {
        let Some(it) = &mut self.recording else { return };
        if is_fault && it.event.is_none() && it.wanted.trigger == CaptureTrigger::Fault {
            it.event = Some(it.rows.len());
        }
        if self.at.flag("capture", "is complete at the end of a run", it.event.is_some()) {
            it.is_complete = true;
        }
    }

    fn read_capture(&mut self, request: &HostMessage, first: u16) {
        let Some(it) = self.recording.as_ref().filter(|it| it.is_complete) else {
            let progress = self.recording.as_ref().map_or(0, |it| 1 + u32::from(it.event.is_some()));
            let detail = self.at.whole("ReadCapture", "detail without rows", progress.into());
            return self.result_with(request, Outcome::NotCaptured, detail as u32);
        };
        let (count, width) = (it.rows.len(), it.rows.first().map_or(1, Vec::len));
        let fit =
            self.at.whole("ReadCapture", "values that fit", MAX_TELEMETRY_VALUES as i64) as usize / width;
        let rows: Vec<_> = it.rows.iter().skip(first.into()).take(fit).flatten().copied().collect();
        let event = it.event.unwrap_or(0) as u16;
        let is_read_once = self.at.flag("ReadCapture", "ends the capture", false);
        match TelemetryValues::new(&rows) {
            Some(values) => self.send(CaptureRows { first, event, values }),
            None => self.result_with(request, Outcome::UnknownIndex, count as u32),
        }
        if is_read_once {
            self.recording = None;
        }
    }
}
