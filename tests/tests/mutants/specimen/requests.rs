//! Requests in each state.

use lashloop_protocol::enums::{
    Capabilities, FaultCode, Outcome, ParameterFlags, ParameterValue, State, Version,
};
use lashloop_protocol::message::{CommandResult, Hello, Identity, ParameterReport, SetParameter};
use lashloop_protocol::text::Text;
use lashloop_protocol::{HostMessage, Message};

use super::Drive;
use super::arming::is_too_stiff;
use super::description::{COUNTS, DAMPING, GAIN, LAWS, PERIOD, SIGNALS};
use super::table::{Cell, cell};

const VERSION: u8 = 1;

impl Drive {
    pub(super) fn handle(&mut self, request: HostMessage) {
        if self.option(&request) {
            return;
        }
        let row = self.row(&request);
        let is_sample_of_run = row == "EncoderSample" && self.state() == State::Running;
        match request {
            HostMessage::EncoderSample(sample) => self.sample(&sample),
            HostMessage::Hello(hello) => self.hello(row, hello),
            HostMessage::SetParameter(set) => self.set_parameter(row, set),
            HostMessage::Subscribe(wanted) => self.subscribe(wanted),
            HostMessage::Arm(_) => self.arm(row),
            HostMessage::DescribeParameter(_)
            | HostMessage::GetParameter(_)
            | HostMessage::DescribeLaw(_)
            | HostMessage::DescribeSignal(_)
            | HostMessage::DescribeChoice(_) => match cell(&self.at, row) {
                Cell::Done(state) => {
                    self.set_state(state);
                    self.describe(&request);
                }
                Cell::Refused(outcome) => self.result(&request, outcome),
            },
            _ => self.command(row, &request),
        }
        // A sample in a run has events of its own, and `Reset` keeps nothing.
        if !is_sample_of_run && row != "Reset" {
            self.after(row);
        }
    }

    /// The row of the table of states.
    fn row(&self, request: &HostMessage) -> &'static str {
        let is_present =
            |session| self.at.flag("session", "is the present one", self.session == Some(session));
        match request {
            HostMessage::Hello(hello) => {
                if self.at.flag("Hello", "is of another version", hello.protocol_version != VERSION) {
                    "Hello, another version"
                } else if is_present(hello.session) {
                    "Hello, same session"
                } else {
                    "Hello, another session"
                }
            }
            HostMessage::SetParameter(set) => {
                let parameter = self.values.table.get(usize::from(set.index));
                let is_live = parameter.is_some_and(|it| it.flags.contains(ParameterFlags::LIVE));
                let matters = matches!(self.state(), State::Armed | State::Running);
                if matters && self.at.flag("SetParameter", "is of a live one", is_live) {
                    "SetParameter, live"
                } else {
                    "SetParameter"
                }
            }
            HostMessage::Arm(arm) if !is_present(arm.session) => "Arm, another session",
            HostMessage::Start(start) if !is_present(start.session) => "Start, another session",
            _ => request.layout().name,
        }
    }

    pub(super) fn result(&mut self, request: &HostMessage, outcome: Outcome) {
        self.result_with(request, outcome, 0);
    }

    pub(super) fn result_with(&mut self, request: &HostMessage, outcome: Outcome, detail: u32) {
        let (request, state) = (request.layout().kind, self.state());
        self.send(CommandResult { request, outcome, state, detail, device_time_us: None });
    }

    fn hello(&mut self, row: &'static str, Hello { protocol_version, session, .. }: Hello) {
        let cell = cell(&self.at, row);
        if let Cell::Done(state) = cell {
            if row == "Hello, another session" && self.at.flag("Hello", "opens a session", true) {
                self.session = Some(session);
                if let Some(run) = &mut self.run
                    && run.last.is_some_and(|last| last > 0)
                    && !self.at.flag("Hello", "keeps the sequence of reports", true)
                {
                    run.last = None;
                }
            }
            self.set_state(state);
        }
        let mut capabilities = self.options();
        capabilities.set(Capabilities::DEVICE_TIME, self.character.has_clock);
        self.send(Identity {
            protocol_version: VERSION,
            minor_version: 0,
            session,
            firmware: Version { major: 3, minor: 1, patch: 4 },
            build_id: 0x5eed_0001,
            dirty: 0,
            state: self.state(),
            board: Text::new("specimen"),
            period_us: whole(self.is_set(PERIOD)),
            motor_counts_per_rev: whole(self.is_set(COUNTS[0])),
            load_counts_per_rev: whole(self.is_set(COUNTS[1])),
            law_count: LAWS.len() as u8,
            signal_count: SIGNALS.len() as u8,
            parameter_count: self.values.table.len() as u8,
            capabilities,
            device_time_us: None,
        });
        let is_latched = self.fault.is_some() && self.state() == State::Faulted;
        if let Some(fault) = self.fault
            && self.at.flag("Hello", "is followed by the latched fault", is_latched)
        {
            self.send(fault);
        }
        if let Cell::Refused(outcome) = cell {
            let part = match protocol_version {
                0 => "of version 0 opens a session",
                u8::MAX => "of version 255 opens a session",
                _ => "of a later version opens a session",
            };
            if self.at.flag("Hello", part, false) {
                self.session = Some(session);
            }
            self.result(&Hello::new(session).into(), outcome);
        }
    }

    fn set_parameter(&mut self, row: &'static str, SetParameter { index, value }: SetParameter) {
        let parameter = self.values.table.get(usize::from(index));
        let state = cell(&self.at, row);
        let of_range = |part, breaks: bool| {
            let applies = parameter.is_some_and(|it| it.default.ty() == value.ty());
            if !applies {
                return None;
            }
            self.at.flag("SetParameter", part, breaks).then_some(Outcome::OutOfRange)
        };
        let range = of_range("is below its range", parameter.is_some_and(|it| is_below(value, it.min)))
            .or(of_range("is above its range", parameter.is_some_and(|it| is_below(it.max, value))))
            .or(of_range("is NaN", is_nan(value)));
        let refusal = self.refusal(
            "SetParameter",
            ["before the index", "before the state", "before the type", "", ""],
            [
                ("refused for its index", parameter.is_none().then_some(Outcome::UnknownIndex)),
                ("refused for the state", refused(state)),
                (
                    "refused for its type",
                    parameter.filter(|it| it.default.ty() != value.ty()).map(|_| Outcome::WrongType),
                ),
                ("refused for its range", range),
                ("refused for another value", self.contradicts(usize::from(index), value)),
            ],
        );
        let stores = refusal.is_none();
        let keeps = if stores { "is stored" } else { "is stored though refused" };
        if parameter.is_some_and(|it| it.default.ty() == value.ty())
            && self.at.flag("SetParameter", keeps, stores)
            && let Some(stored) = self.values.set.get_mut(usize::from(index))
        {
            *stored = value;
        }
        if let (Cell::Done(state), None) = (state, refusal) {
            self.set_state(state);
        }
        self.report(index, refusal.unwrap_or(Outcome::Accepted), Some(value));
    }

    /// In a run a gain must go with the damping.
    fn contradicts(&self, index: usize, value: ParameterValue) -> Option<Outcome> {
        let is_real = matches!(value, ParameterValue::F32(_));
        let matters = index == GAIN && is_real && matches!(self.state(), State::Armed | State::Running);
        let mut values = self.values;
        values.set[GAIN] = value;
        (matters && is_too_stiff(&values)).then_some(Outcome::Inconsistent)
    }

    /// Reports the value in force; `requested` is what a mistaken drive reports.
    pub(super) fn report(&mut self, index: u8, outcome: Outcome, requested: Option<ParameterValue>) {
        let value = self.values.set.get(usize::from(index)).copied().unwrap_or(ParameterValue::U32(0));
        let requested = requested.unwrap_or(value);
        let default = self.values.table.get(usize::from(index)).map_or(value, |it| it.default);
        let value = match self.at.pick("ParameterReport", "source of the value", 0, &[0, 1, 2]) {
            0 => value,
            1 => requested,
            _ => default,
        };
        let (state, detail) =
            (self.state(), if outcome == Outcome::Inconsistent { DAMPING as u32 } else { 0 });
        self.send(ParameterReport { index, outcome, value, state, detail, device_time_us: None });
    }

    /// Requests without fields that change the state, and `Start`.
    fn command(&mut self, row: &'static str, request: &HostMessage) {
        if matches!(request, HostMessage::Stop(_)) {
            self.send(self.counts);
        }
        let outcome = match cell(&self.at, row) {
            Cell::Done(state) => {
                self.set_state(state);
                self.effect(request);
                Outcome::Accepted
            }
            Cell::Refused(outcome) => {
                let done = match request {
                    HostMessage::Start(_) => Some(State::Running),
                    HostMessage::Stop(_) | HostMessage::ClearFault(_) => Some(State::Idle),
                    _ => None,
                };
                if let Some(done) = done
                    && done != self.state()
                    && self.at.flag(row, "is done though refused", false)
                {
                    self.set_state(done);
                    self.effect(request);
                }
                outcome
            }
        };
        self.result(request, outcome);
    }

    fn effect(&mut self, request: &HostMessage) {
        match request {
            HostMessage::Start(_) => {
                self.run = self.run.as_ref().map(|run| run.restarted(&self.at));
                if self.at.flag("Start resets", "the watchdog", true) {
                    self.fed_us = self.now_us;
                }
                if self.at.flag("Start resets", "the line counts", true) {
                    self.clear_counts();
                }
            }
            HostMessage::Stop(_) => {
                let at_arm = self.run.as_ref().map(|run| run.settings.set[GAIN]);
                if let Some(at_arm) = at_arm.filter(|at_arm| *at_arm != self.is_set(GAIN))
                    && !self.at.flag("Stop", "keeps a live value", true)
                {
                    self.values.set[GAIN] = at_arm;
                }
            }
            HostMessage::EmergencyStop(_) => {
                let code = self.at.fault("EmergencyStop", FaultCode::EmergencyStop);
                let report = self.trip(code, 0.0, 0.0);
                self.send(report);
            }
            HostMessage::ClearFault(_) => {
                if self.at.flag("ClearFault", "forgets the fault", true) {
                    self.fault = None;
                }
                if self.at.flag("ClearFault", "replaces no handshake", self.session.is_none()) {
                    self.set_state(State::Boot);
                }
            }
            HostMessage::Reset(_) => self.reset(),
            _ => {}
        }
    }

    fn reset(&mut self) {
        let has_run = self.run.as_ref().is_some_and(|run| run.last.is_some());
        self.watches_in_boot = has_run && !self.at.flag("Reset restores", "no watchdog", true);
        self.first_law = None;
        let restores = |what| self.at.flag("Reset restores", what, true);
        let defaults = self.defaults().set;
        for ((value, default), parameter) in self.values.set.iter_mut().zip(defaults).zip(self.values.table) {
            if restores(parameter.name) {
                *value = default;
            }
        }
        if self.recording.is_some() && restores("no capture") {
            self.recording = None;
        }
        if restores("no subscription") {
            (self.signals, self.every) = (0, 0);
        }
        if restores("no session") {
            self.session = None;
        }
        if restores("no fault") {
            self.fault = None;
        }
        if restores("no run") {
            self.run = None;
        }
        self.at.restart();
    }
}

pub(super) fn whole(value: ParameterValue) -> u32 {
    match value {
        ParameterValue::U32(value) => value,
        ParameterValue::F32(value) => value as u32,
        ParameterValue::Unknown { .. } => 0,
    }
}

pub(super) fn refused(cell: Cell) -> Option<Outcome> {
    match cell {
        Cell::Done(_) => None,
        Cell::Refused(outcome) => Some(outcome),
    }
}

fn is_below(value: ParameterValue, limit: ParameterValue) -> bool {
    match (value, limit) {
        (ParameterValue::U32(value), ParameterValue::U32(limit)) => value < limit,
        (ParameterValue::F32(value), ParameterValue::F32(limit)) => value < limit,
        _ => false,
    }
}

fn is_nan(value: ParameterValue) -> bool {
    matches!(value, ParameterValue::F32(value) if value.is_nan())
}
