//! Requests of the host: who are you, set this, arm, start, stop.

use core::time::Duration;

use lashloop_protocol::enums::{Controllers, LogLevel, Outcome, ParameterValue, State};
use lashloop_protocol::message::{
    CommandResult, Hello, Identity, LineReport, ParameterDescription, ParameterReport, SetParameter,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{HostMessage, PROTOCOL_VERSION, message};

use super::control_loop::ControlLoop;
use super::parameters::{Parameters, TABLE};
use super::safety::Safety;
use super::{BUILD_ID, Clock, Drive, FIRMWARE_VERSION};

impl Drive {
    pub(super) fn handle(&mut self, message: &HostMessage, clock: &impl Clock) {
        match message {
            HostMessage::EncoderSample(sample) => self.answer_sample(sample, clock),
            HostMessage::Hello(hello) => self.greet(hello),
            HostMessage::DescribeParameter(request) => self.describe(request.index),
            HostMessage::GetParameter(request) => {
                let known = usize::from(request.index) < TABLE.len();
                self.report(request.index, if known { Outcome::Accepted } else { Outcome::UnknownParameter });
            }
            HostMessage::SetParameter(request) => {
                let outcome = self.set(request);
                self.report(request.index, outcome);
            }
            HostMessage::Arm(arm) => {
                let outcome = self.in_session(arm.session).unwrap_or_else(|| self.arm());
                self.conclude::<message::Arm>(outcome);
            }
            HostMessage::Start(start) => {
                let outcome = self.in_session(start.session).unwrap_or_else(|| self.start(clock.now()));
                self.conclude::<message::Start>(outcome);
            }
            HostMessage::Stop(_) => {
                let outcome = self.safety.stop();
                self.control = None;
                self.report_line();
                self.conclude::<message::Stop>(outcome);
            }
            HostMessage::EmergencyStop(_) => {
                self.latch(self.safety.emergency_stop());
                self.conclude::<message::EmergencyStop>(Outcome::Accepted);
            }
            HostMessage::ClearFault(_) => {
                let outcome = self.safety.clear_fault(self.session.is_some());
                self.conclude::<message::ClearFault>(outcome);
            }
            HostMessage::Reset(_) => {
                self.safety = Safety::new();
                self.parameters = Parameters::default();
                (self.session, self.control, self.last_answer) = (None, None, None);
                self.conclude::<message::Reset>(Outcome::Accepted);
            }
        }
    }

    /// Tells the host that a request could not be done as asked.
    pub(super) fn conclude<Request: Payload>(&mut self, outcome: Outcome) {
        let state = self.safety.state();
        self.output.send(CommandResult { request: Request::LAYOUT.kind, outcome, state });
    }

    fn greet(&mut self, hello: &Hello) {
        let understood = hello.protocol_version == PROTOCOL_VERSION;
        if understood && self.session != Some(hello.session) {
            self.session = Some(hello.session);
            self.control = None;
            self.safety.greet();
        }
        // An identity goes out in any case: a host of another version has to learn whom it met.
        self.output.send(Identity {
            protocol_version: PROTOCOL_VERSION,
            session: hello.session,
            firmware: FIRMWARE_VERSION,
            build_id: BUILD_ID,
            state: self.safety.state(),
            board: Text::new(self.board),
            period_us: self.parameters.period_us,
            motor_counts_per_rev: self.parameters.motor_counts_per_rev,
            load_counts_per_rev: self.parameters.load_counts_per_rev,
            controllers: Controllers::all(),
            parameter_count: TABLE.len() as u8,
        });
        if let Some(fault) = self.safety.fault() {
            self.output.send(fault);
        }
        if !understood {
            self.conclude::<Hello>(Outcome::VersionMismatch);
        }
    }

    fn describe(&mut self, index: u8) {
        let Some(entry) = TABLE.get(usize::from(index)) else {
            return self.report(index, Outcome::UnknownParameter);
        };
        self.output.send(ParameterDescription {
            index,
            live: u8::from(entry.live),
            default: entry.default,
            min: entry.min,
            max: entry.max,
            name: Text::new(entry.name),
            unit: Text::new(entry.unit),
        });
    }

    fn set(&mut self, request: &SetParameter) -> Outcome {
        let Some(entry) = TABLE.get(usize::from(request.index)) else {
            return Outcome::UnknownParameter;
        };
        match self.safety.state() {
            State::Idle => entry.set(&mut self.parameters, request.value),
            State::Armed | State::Running if entry.live => entry.set(&mut self.parameters, request.value),
            _ => Outcome::WrongState,
        }
    }

    fn report(&mut self, index: u8, outcome: Outcome) {
        let value = TABLE.get(usize::from(index)).map_or(ParameterValue::U32(0), |e| e.get(&self.parameters));
        let state = self.safety.state();
        self.output.send(ParameterReport { index, outcome, value, state });
    }

    /// `None` if the request belongs to the present session.
    fn in_session(&self, session: u32) -> Option<Outcome> {
        (self.session != Some(session)).then_some(Outcome::WrongSession)
    }

    /// The controller is built when arming, so that parameters which don't go together are found before the start.
    fn arm(&mut self) -> Outcome {
        if self.safety.state() != State::Idle {
            return Outcome::WrongState;
        }
        match ControlLoop::new(&self.parameters) {
            Ok(control) => {
                self.control = Some(control);
                self.safety.arm()
            }
            Err(error) => {
                self.log(LogLevel::Error, &[error.name, " does not go with the others"]);
                Outcome::Inconsistent
            }
        }
    }

    fn start(&mut self, now: Duration) -> Outcome {
        let outcome = self.safety.start(&self.parameters, now);
        if outcome == Outcome::Accepted {
            self.counters_at_start = *self.decoder.counters();
            self.overruns = 0;
            self.last_answer = None;
        }
        outcome
    }

    fn report_line(&mut self) {
        let (now, then) = (self.decoder.counters(), &self.counters_at_start);
        self.output.send(LineReport {
            messages: now.messages - then.messages,
            damaged: now.damaged() - then.damaged(),
            refused: now.refused - then.refused,
            overruns: self.overruns,
        });
    }
}
