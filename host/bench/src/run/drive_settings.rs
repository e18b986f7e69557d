//! What a scenario sets on a drive, checked against the drive's description of itself. Nothing is sent here.

use std::time::Duration;

use lashloop_protocol::enums::{CaptureTrigger, ParameterValue};
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;
use lashloop_protocol::parameter_names::{
    BENCH_SAMPLE_EVERY, CONTROLLER, LOAD_COUNTS_PER_REV, MOTOR_COUNTS_PER_REV, PERIOD_US, SAMPLE_SOURCE,
    WATCHDOG_US,
};

use crate::scenario::bench::{BenchStart, TORQUE_PER_RAD_NM, key_of_pin};
use crate::scenario::controller::{self, ParameterSetting};
use crate::scenario::scope::{ScopeSettings, ScopeTrigger};
use crate::scenario::sections::SignalChoice;
use crate::scenario::{Origin, Scenario, ScenarioError, ScenarioErrors};
use lashloop_session::names::UnknownName;
use lashloop_session::{
    CaptureError, CaptureRequest, DriveSignal, Law, Parameter, Session, Subscription, WrittenValue,
};

/// Parameters of bench mode that the bench sets itself, and the keys that they follow.
const OF_BENCH_MODE: [(&str, &str); 2] =
    [(SAMPLE_SOURCE, "run.mode"), (BENCH_SAMPLE_EVERY, "bench.sample_every")];
/// Choice `pins` of [`SAMPLE_SOURCE`].
const PINS: f64 = 1.0;

/// What a scenario sets on a drive.
pub(super) struct DriveSettings<'a> {
    /// Parameters that every drive must have, with their values.
    pub(super) required: Vec<(&'static str, f64)>,
    /// Those of `[bench]`, in bench mode, then those of `[controller.parameters]` that the law has.
    pub(super) parameters: Vec<&'a ParameterSetting>,
    pub(super) subscription: Subscription,
    pub(super) capture: Option<CaptureRequest>,
    /// What the scenario has and the drive is not given, for the log of the run.
    pub(super) notes: Vec<String>,
}

impl<'a> DriveSettings<'a> {
    /// The settings of a scenario for the drive of this session. `None` leaves its watchdog as it is.
    ///
    /// # Errors
    /// The drive has no such law, parameter, choice or signal, or the law in force has not; all errors at once, each with its
    /// place in the scenario.
    pub(super) fn new(
        scenario: &'a Scenario,
        session: &Session,
        watchdog: Option<Duration>,
    ) -> Result<Self, ScenarioErrors> {
        let law = law(scenario, session)?;
        check_start(scenario, session, law)?;
        let mut errors = Vec::new();
        let mut notes = Vec::new();
        let from_sections = from_sections(scenario, law);
        let parameters = scenario.controller.parameters.iter().filter(|setting| {
            match check(setting, scenario, session, law, &from_sections) {
                Ok(None) => return true,
                Ok(Some(note)) => notes.push(note),
                Err(error) => errors.push(error),
            }
            false
        });
        let of_pins = scenario.bench.parameters.iter().filter(|_| !scenario.run.mode.is_hil());
        let parameters = of_pins.chain(parameters).collect();
        let subscription = match &scenario.telemetry.signals {
            Some(choices) => {
                let signals = TELEMETRY.chosen(choices, session, law, &mut errors);
                Subscription::new(signals, scenario.telemetry.every_steps)
            }
            None => {
                let every = scenario.telemetry.every_steps;
                let (subscription, left_out) = Subscription::to_all(&session.signals, law.index, every);
                if !left_out.is_empty() && every > 0 {
                    let names: Vec<_> = left_out.iter().map(|it| &*it.signal.name).collect();
                    notes.push(format!(
                        "a telemetry has {MAX_TELEMETRY_VALUES} signals at most, so it lacks {}; telemetry.signals selects them",
                        names.join(", ")
                    ));
                }
                subscription
            }
        };
        let capture = capture(&scenario.scope, session, law, &mut errors);
        if !errors.is_empty() {
            return Err(errors.into());
        }
        scenario.check_drive(|name| default_of(session, law, name))?;
        // A drive with one law may lack the choice of a law.
        let is_optional =
            |name| name == CONTROLLER && session.laws.len() == 1 && session.parameter(name).is_none();
        let mut required: Vec<_> = from_sections.into_iter().map(|(name, _, value)| (name, value)).collect();
        required.retain(|(name, _)| !is_optional(*name));
        if !scenario.run.mode.is_hil() {
            required
                .extend([(SAMPLE_SOURCE, PINS), (BENCH_SAMPLE_EVERY, scenario.bench.sample_every.into())]);
            required.extend(travel(scenario, session));
        } else if let Some(watchdog) = watchdog {
            required.push((WATCHDOG_US, 1e6 * watchdog.as_secs_f64()));
        }
        Ok(Self { required, parameters, subscription, capture, notes })
    }
}

/// The travel of `[bench]` as limits of a drive that has them: it stops without the host, too. Its zero is the start.
fn travel(scenario: &Scenario, session: &Session) -> Vec<(&'static str, f64)> {
    let (Some(limit_rad), BenchStart::Initial) = (scenario.bench.load_travel_limit_rad, scenario.bench.start)
    else {
        return Vec::new();
    };
    let start_rad = scenario.plant.initial.load_position_rad;
    let limits =
        [("load_travel_min_rad", -limit_rad - start_rad), ("load_travel_max_rad", limit_rad - start_rad)];
    let is_set = |name: &str| scenario.bench.parameters.iter().any(|it| it.name == name);
    limits.into_iter().filter(|(name, _)| session.parameter(name).is_some() && !is_set(name)).collect()
}

/// Parameters that keys outside `[controller.parameters]` set: name, key and value.
fn from_sections(scenario: &Scenario, law: &Law) -> [(&'static str, &'static str, f64); 4] {
    let Scenario { run, encoders, .. } = scenario;
    [
        (CONTROLLER, "controller.name", law.index.into()),
        (PERIOD_US, "run.control_period_us", run.control_period_us.into()),
        (MOTOR_COUNTS_PER_REV, "encoders.motor_counts_per_rev", encoders.motor_counts_per_rev.into()),
        (LOAD_COUNTS_PER_REV, "encoders.load_counts_per_rev", encoders.load_counts_per_rev.into()),
    ]
}

/// Default of a parameter that the law has, if it is a real number.
fn default_of(session: &Session, law: &Law, name: &str) -> Option<f64> {
    match session.parameter(name).filter(|parameter| parameter.laws.contains(law.index))?.default {
        ParameterValue::F32(default) => Some(default.into()),
        ParameterValue::U32(_) | ParameterValue::Unknown { .. } => None,
    }
}

/// The law that the scenario names.
fn law<'s>(scenario: &Scenario, session: &'s Session) -> Result<&'s Law, ScenarioError> {
    let wanted = &scenario.controller;
    session.laws.iter().find(|law| law.name == wanted.name).ok_or_else(|| {
        let known = session.laws.iter().map(|law| &*law.name);
        let reason = UnknownName::new("the drive", "law", &wanted.name, known);
        ScenarioError::by_drive(&wanted.origin, "controller.name", format!("{:?}", wanted.name), reason)
    })
}

/// Whether the law of a scenario takes its reference as a torque, by the drive's description.
#[must_use]
pub fn takes_torque(scenario: &Scenario, session: &Session) -> bool {
    law(scenario, session).is_ok_and(|law| commands_torque(session, law))
}

fn commands_torque(session: &Session, law: &Law) -> bool {
    session.parameter(TORQUE_PER_RAD_NM).is_some_and(|parameter| parameter.laws.contains(law.index))
}

/// A law of positions would jump from where the load stands to the first reference.
fn check_start(scenario: &Scenario, session: &Session, law: &Law) -> Result<(), ScenarioError> {
    let (start, chosen) = (scenario.bench.start, &scenario.controller);
    if scenario.run.mode.is_hil() || start == BenchStart::Initial || commands_torque(session, law) {
        return Ok(());
    }
    let reason = format!(
        "bench.start = \"anywhere\" needs a law that takes its reference as a torque, by the parameter {TORQUE_PER_RAD_NM}"
    );
    Err(ScenarioError::by_drive(&chosen.origin, "controller.name", format!("{:?}", law.name), reason))
}

/// Checks a parameter of the scenario. A note says why it is left out.
fn check(
    setting: &ParameterSetting,
    scenario: &Scenario,
    session: &Session,
    law: &Law,
    from_sections: &[(&str, &str, f64)],
) -> Result<Option<String>, ScenarioError> {
    let of_sections = from_sections.iter().map(|(name, key, _)| (*name, *key)).chain(OF_BENCH_MODE);
    let of_sections = of_sections.into_iter().find(|(name, _)| *name == setting.name);
    let of_pins = || key_of_pin(&setting.name);
    if let Some(key) = of_sections.map(|(_, key)| key.to_owned()).or_else(of_pins) {
        return Err(ScenarioError::parameter(setting, format!("is set by {key}; set it there")));
    }
    let parameter = session.parameter(&setting.name).ok_or_else(|| {
        let known = session.parameters.iter().map(|parameter| &*parameter.name);
        let unknown = UnknownName::new("the drive", "parameter", &setting.name, known);
        ScenarioError::parameter(setting, format!("is refused: {unknown}"))
    })?;
    if !parameter.laws.contains(law.index) {
        return foreign(setting, scenario, session, parameter);
    }
    let value = parameter.value(written(&setting.value));
    value.map_err(|error| ScenarioError::parameter(setting, format!("is refused: {error}")))?;
    Ok(None)
}

/// A parameter of another law is an error, except where the command line has replaced the law that the file sets it for.
fn foreign(
    setting: &ParameterSetting,
    scenario: &Scenario,
    session: &Session,
    parameter: &Parameter,
) -> Result<Option<String>, ScenarioError> {
    let (laws, chosen) = (parameter.laws.names(&session.laws), &scenario.controller);
    let name = &setting.name;
    match (chosen.origin.replacement(), &setting.origin) {
        (Some(option), Origin::File { .. }) => Ok(Some(format!(
            "controller.parameters.{name} of {} is left out: it belongs to {laws}, and {option} chooses {}",
            setting.origin, chosen.name
        ))),
        _ => Err(ScenarioError::parameter(
            setting,
            format!("is given, but {name} belongs to {laws}, and this run uses {}", chosen.name),
        )),
    }
}

/// A list of signals of a scenario.
struct SignalList {
    key: &'static str,
    /// What carries the signals, in words, and how many it carries.
    carrier: &'static str,
    most: usize,
}

const TELEMETRY: SignalList =
    SignalList { key: "telemetry.signals", carrier: "a telemetry", most: MAX_TELEMETRY_VALUES };
const SCOPE: SignalList = SignalList { key: "scope.signals", carrier: "a capture", most: 4 };

impl SignalList {
    /// The signals that the scenario names.
    fn chosen(
        &self,
        choices: &[SignalChoice],
        session: &Session,
        law: &Law,
        errors: &mut Vec<ScenarioError>,
    ) -> Vec<DriveSignal> {
        let mut signals = Vec::new();
        for choice in choices {
            let name = &*choice.name;
            let refusal = match session.signal(name) {
                None => {
                    let known = session.signals.iter().map(|it| &*it.signal.name);
                    UnknownName::new("the drive", "signal", name, known).to_string()
                }
                Some(signal) if !signal.laws.contains(law.index) => {
                    let laws = signal.laws.names(&session.laws);
                    format!("it belongs to {laws}, and this run uses {}", law.name)
                }
                Some(signal) if signals.contains(signal) => "it is given twice".to_owned(),
                Some(_) if signals.len() == self.most => {
                    format!("it is one too many; {} has {} signals at most", self.carrier, self.most)
                }
                Some(signal) => {
                    signals.push(signal.clone());
                    continue;
                }
            };
            errors.push(ScenarioError::by_drive(&choice.origin, self.key, format!("{name:?}"), refusal));
        }
        signals
    }
}

/// The capture of the scenario, if it has one.
fn capture(
    scope: &ScopeSettings,
    session: &Session,
    law: &Law,
    errors: &mut Vec<ScenarioError>,
) -> Option<CaptureRequest> {
    let (choices, first) = (scope.signals.as_ref()?, scope.first()?);
    if !session.has_scope() {
        let value = format!("{:?}", first.name);
        errors.push(ScenarioError::by_drive(&first.origin, SCOPE.key, value, CaptureError::Unsupported));
        return None;
    }
    let signals = SCOPE.chosen(choices, session, law, errors);
    let source = scope.trigger_signal.as_ref().unwrap_or(first);
    let trigger_signal = signals.iter().find(|it| it.signal.name == source.name).map(|it| it.index);
    if trigger_signal.is_none() && scope.trigger_signal.is_some() {
        let known = signals.iter().map(|it| &*it.signal.name);
        let refusal = UnknownName::new("the capture", "signal", &source.name, known);
        let (origin, value) = (&source.origin, format!("{:?}", source.name));
        errors.push(ScenarioError::by_drive(origin, "scope.trigger_signal", value, refusal));
    }
    let mut capture = CaptureRequest::new(signals);
    (capture.every, capture.before) = (scope.every_steps, scope.before_rows);
    (capture.trigger_signal, capture.level) = (trigger_signal?, scope.level as f32);
    capture.trigger = match scope.trigger {
        ScopeTrigger::Now => CaptureTrigger::Now,
        ScopeTrigger::Rising => CaptureTrigger::Rising,
        ScopeTrigger::Falling => CaptureTrigger::Falling,
        ScopeTrigger::Fault => CaptureTrigger::Fault,
    };
    Some(capture)
}

/// A value of the scenario as the session takes it.
pub(super) fn written(value: &controller::ParameterValue) -> WrittenValue<'_> {
    match value {
        controller::ParameterValue::Number(number) => WrittenValue::Number(*number),
        controller::ParameterValue::Boolean(on) => WrittenValue::Number(f64::from(u8::from(*on))),
        controller::ParameterValue::Text(text) => WrittenValue::Name(text),
    }
}

#[cfg(test)]
mod tests;
