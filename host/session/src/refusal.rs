//! Why a drive refuses a request, in words: from the outcome, its detail and the drive's description.

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{CommandResult, ParameterReport};

use crate::error::SessionError;
use crate::line::Line;
use crate::parameters::Parameter;
use crate::signals::DriveSignal;

/// What a drive answers to a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reply {
    /// The outcome.
    pub outcome: Outcome,
    /// State of the drive.
    pub state: State,
    /// Further detail, as defined by the outcome.
    pub detail: u32,
}

impl From<&CommandResult> for Reply {
    fn from(&CommandResult { outcome, state, detail, .. }: &CommandResult) -> Self {
        Self { outcome, state, detail }
    }
}

impl From<&ParameterReport> for Reply {
    fn from(&ParameterReport { outcome, state, detail, .. }: &ParameterReport) -> Self {
        Self { outcome, state, detail }
    }
}

impl Line {
    /// Why the drive has refused a request. Asks the drive for the names that this bench lacks.
    pub(crate) fn cause_of(
        &mut self,
        reply: Reply,
        parameters: &[Parameter],
        signals: &[DriveSignal],
    ) -> String {
        let name = self.name_of(reply.outcome);
        let cause = reply.cause(&name, parameters, signals);
        match self.own_name(reply.state) {
            Some(state) => format!("{cause}, in the drive's state {state}"),
            None => cause,
        }
    }

    /// The error for a refused request.
    pub(crate) fn refused(
        &mut self,
        request: &'static str,
        reply: Reply,
        parameters: &[Parameter],
        signals: &[DriveSignal],
    ) -> SessionError {
        let cause = self.cause_of(reply, parameters, signals);
        let Reply { outcome, state, detail } = reply;
        SessionError::Refused { request, outcome, state, detail, cause, last_seen: self.last_seen }
    }
}

impl Reply {
    /// The cause, such as `Inconsistent: period_us does not go with the other parameters`. `name` is that of the outcome.
    #[must_use]
    pub fn cause(&self, name: &str, parameters: &[Parameter], signals: &[DriveSignal]) -> String {
        match self.reason(parameters, signals) {
            Some(reason) => format!("{name}: {reason}"),
            None => name.to_owned(),
        }
    }

    fn reason(&self, parameters: &[Parameter], signals: &[DriveSignal]) -> Option<String> {
        let detail = self.detail;
        let reason = match (self.outcome, detail) {
            (Outcome::Inconsistent, index) => {
                let named = parameters.iter().find(|it| u32::from(it.index) == index).map(|it| &*it.name);
                let name = named.map_or_else(|| format!("parameter {index}"), str::to_owned);
                format!("{name} does not go with the other parameters")
            }
            (Outcome::SignalOfOtherLaw, index) => {
                let named = signals.iter().find(|it| u32::from(it.index) == index);
                format!("signal {}", named.map_or_else(|| index.to_string(), |it| it.signal.name.to_string()))
            }
            (Outcome::PowerStageFault, 1) => "the break input is active".to_owned(),
            (Outcome::PowerStageFault, 2) => "the fault line is active".to_owned(),
            (Outcome::PowerStageFault, 3) => "its supply is missing: is it switched on?".to_owned(),
            (Outcome::PowerStageFault, 4) => "overcurrent".to_owned(),
            (Outcome::PowerStageFault, 5) => "overtemperature".to_owned(),
            (Outcome::EncoderImplausible, 1) => "the encoders were not read since power-up".to_owned(),
            (Outcome::EncoderImplausible, 2) => "the motor encoder moved too fast".to_owned(),
            (Outcome::EncoderImplausible, 3) => "the load encoder moved too fast".to_owned(),
            (Outcome::EncoderImplausible, 4) => {
                "both channels of the motor encoder changed at once".to_owned()
            }
            (Outcome::EncoderImplausible, 5) => {
                "both channels of the load encoder changed at once".to_owned()
            }
            (Outcome::StoreFailed, 1) => {
                "its memory refuses to be written; what was stored before is kept".to_owned()
            }
            (Outcome::StoreFailed, 2) => "its memory is full until the next power-up".to_owned(),
            (Outcome::NotCaptured, 0) => "no capture was requested since the reset".to_owned(),
            (Outcome::NotCaptured, 1) => "the event did not come".to_owned(),
            (Outcome::NotCaptured, 2) => "rows are still to come after the event".to_owned(),
            // Nothing was refused, and what the request asked for is missing.
            (Outcome::Accepted, _) => "but without the answer that the request has".to_owned(),
            (_, 0) => return None,
            (_, detail) => format!("detail {detail}"),
        };
        Some(reason)
    }
}

#[cfg(test)]
mod tests {
    use lashloop_plant::Signal;
    use lashloop_protocol::enums::ParameterValue;

    use super::*;
    use crate::laws::LawMask;

    fn cause(outcome: Outcome, detail: u32) -> String {
        let [default, min, max] = [1, 0, 1].map(ParameterValue::U32);
        let parameter = Parameter {
            index: 3,
            name: "period_us".to_owned(),
            unit: "us".to_owned(),
            default,
            min,
            max,
            live: false,
            laws: LawMask(1),
            choices: Vec::new(),
        };
        let signal = DriveSignal { index: 3, laws: LawMask(1), signal: Signal::new("twist_rad", "rad") };
        let reply = Reply { outcome, state: State::Idle, detail };
        reply.cause(&outcome.to_string(), &[parameter], &[signal])
    }

    #[test]
    fn a_cause_has_the_drive_s_own_names() {
        let inconsistent = "Inconsistent: period_us does not go with the other parameters";
        assert_eq!(cause(Outcome::Inconsistent, 3), inconsistent);
        assert_eq!(cause(Outcome::SignalOfOtherLaw, 3), "SignalOfOtherLaw: signal twist_rad");
        let unknown = "Inconsistent: parameter 7 does not go with the other parameters";
        assert_eq!(cause(Outcome::Inconsistent, 7), unknown);
        assert_eq!(cause(Outcome::SignalOfOtherLaw, 7), "SignalOfOtherLaw: signal 7");
    }

    #[test]
    fn a_cause_of_bench_mode_names_the_line_or_the_encoder() {
        assert_eq!(cause(Outcome::PowerStageFault, 2), "PowerStageFault: the fault line is active");
        let causes = (1..=5).map(|detail| cause(Outcome::EncoderImplausible, detail)).collect::<Vec<_>>();
        assert!(causes[1].ends_with("motor encoder moved too fast") && causes[4].contains("load encoder"));
        assert_eq!(cause(Outcome::EncoderImplausible, 9), "EncoderImplausible: detail 9", "a newer drive's");
    }

    #[test]
    fn an_outcome_without_a_detail_is_its_name() {
        assert_eq!(cause(Outcome::WrongState, 0), "WrongState");
        let unknown = Outcome::from_byte(77).expect("an outcome");
        assert_eq!(cause(unknown, 0), "unknown 77");
    }
}
