//! Expectations that a scenario can't measure: errors before the run.
//!
//! A rehearsal of the run decides ([`Plan::obstacle`]); this module puts its reason into a sentence at the place in the file.
//! Reading a scenario finds what run, reference and window rule out. Once the drive is set up, the signals are known, and
//! [`Scenario::check_expectations`](crate::scenario::Scenario::check_expectations) finds the rest.

use lashloop_plant::metrics::{
    DRIVE_PREFIX, Measured, Plan, Quantity, RunStart, SignalTable, assumed_signals,
};
use lashloop_plant::reference::Reference;

use super::{Expectation, error, wrong_unit};
use crate::scenario::controller::ControllerSettings;
use crate::scenario::error::ScenarioError;
use crate::scenario::origin::Origin;
use crate::scenario::plant::PlantSettings;
use crate::scenario::sections::{RunSettings, TelemetrySettings};
use crate::scenario::spelling::{spell_number, spell_text};
use lashloop_session::names::UnknownName;

/// Why bench mode has no signal of the plant, and what to do.
const NO_TRUTH: &str = "is not measured on a bench, which has encoders only; take another metric, a signal of the drive, or \
                        run.mode = \"hil\"";

/// The expectations of a scenario, and what decides whether its run can measure them.
pub(in crate::scenario) struct PlannedRun<'a> {
    pub(in crate::scenario) expectations: &'a [Expectation],
    pub(in crate::scenario) run: &'a RunSettings,
    pub(in crate::scenario) plant: &'a PlantSettings,
    pub(in crate::scenario) controller: &'a ControllerSettings,
    pub(in crate::scenario) reference: &'a Reference,
    pub(in crate::scenario) telemetry: &'a TelemetrySettings,
}

/// The expectations that can't be measured with these signals, or with any if they aren't known yet.
pub(in crate::scenario) fn unmeasurable(
    planned: &PlannedRun<'_>,
    signals: Option<&SignalTable>,
) -> Vec<ScenarioError> {
    let expectations = planned.expectations.iter().enumerate();
    expectations.filter_map(|(index, expectation)| check(planned, signals, index, expectation)).collect()
}

fn check(
    planned: &PlannedRun<'_>,
    signals: Option<&SignalTable>,
    index: usize,
    expectation: &Expectation,
) -> Option<ScenarioError> {
    let places = &expectation.places;
    // Without a place there is no file to correct; the judgement reports why the value is missing.
    let place = places.quantity.as_ref()?;
    if let Some((key, origin, found, reason)) = outside_run(planned, expectation) {
        return Some(error(index, key, origin.unwrap_or(place), spell_number(found), reason));
    }
    let mut assumed = assumed_signals(&expectation.quantity);
    if !planned.run.mode.is_hil() {
        // Nothing simulates a plant, so there is no truth.
        assumed.plant.clear();
    }
    let plan = Plan {
        period_s: planned.run.control_period_s(),
        steps: planned.run.steps(),
        reference: Some(planned.reference),
        signals: signals.unwrap_or(&assumed),
    };
    let start = RunStart {
        load_position_rad: planned.plant.initial.load_position_rad,
        telemetry_every: planned.telemetry.every_steps,
    };
    let (key, name) = match &expectation.quantity {
        Quantity::Metric(metric) => ("metric", metric.name()),
        Quantity::Statistic { signal, .. } => ("signal", signal.as_str()),
    };
    if let Some(obstacle) = plan.obstacle(&expectation.query(), &start) {
        let reason = sentence(planned, expectation, plan.signals, obstacle);
        return Some(error(index, key, place, spell_text(name), reason));
    }
    let unit = signals.and_then(|signals| signals.unit(name)).filter(|unit| *unit != expectation.unit)?;
    let origin = places.unit.as_ref().unwrap_or(place);
    Some(error(index, "unit", origin, spell_text(&expectation.unit), wrong_unit(name, unit)))
}

type OutsideRun<'a> = (&'static str, Option<&'a Origin>, f64, String);

/// The end of the window that lies outside the run.
fn outside_run<'a>(planned: &PlannedRun<'_>, expectation: &'a Expectation) -> Option<OutsideRun<'a>> {
    let (window, run, places) = (expectation.window?, planned.run, &expectation.places);
    let duration_s = run.duration_s;
    if run.step_at(window.from_s) >= run.steps() {
        let reason = format!("is not within the run of {duration_s} s; it must be < {duration_s} s");
        return Some(("from_s", places.from_s.as_ref(), window.from_s, reason));
    }
    let to_s = window.to_s?;
    if run.step_at(to_s) > run.steps() {
        let reason = format!("is after the end of the run; it must be <= {duration_s} s");
        return Some(("to_s", places.to_s.as_ref(), to_s, reason));
    }
    (run.step_at(to_s) <= run.step_at(window.from_s)).then(|| {
        let period_s = run.control_period_s();
        let reason = format!("is less than one control period of {period_s} s after from_s");
        ("to_s", places.to_s.as_ref(), to_s, reason)
    })
}

/// Why the quantity can't be measured and what to change, to follow its name.
fn sentence(
    planned: &PlannedRun<'_>,
    expectation: &Expectation,
    signals: &SignalTable,
    obstacle: Measured,
) -> String {
    let part = if expectation.window.is_some() { "window" } else { "run" };
    let end_s = expectation.window.and_then(|window| window.to_s).unwrap_or(planned.run.duration_s);
    match obstacle {
        Measured::RunTooShort => {
            let length_s = end_s - expectation.window.map_or(0.0, |window| window.from_s);
            let meaning = match &expectation.quantity {
                Quantity::Metric(metric) => metric.meaning(),
                Quantity::Statistic { statistic, .. } => statistic.meaning(),
            };
            format!("needs a longer {part} than {length_s} s; its definition: {meaning}")
        }
        Measured::NoInitialError => {
            "refers to an error at the start, but the load starts where the reference leads it; set from_s to the time at which \
             the error begins, or take another metric"
                .to_owned()
        }
        Measured::NoReversal => format!(
            "needs a reference that passes its middle upwards and downwards within the {part}; take a sine or a table, or make the \
             {part} longer"
        ),
        Measured::NoMove => format!(
            "needs a reference that moves within the {part}; settle_time_s judges a constant reference"
        ),
        Measured::NoEndOfMotion => format!(
            "needs a reference at rest at the end of the {part}, but it still moves at {end_s} s; make the {part} longer, or take \
             a reference that ends"
        ),
        Measured::NoSteadyVelocity => format!(
            "needs a reference that moves at constant velocity for 0.2 s or more within the {part}; take a trapezoid or a table"
        ),
        Measured::NoTelemetry => match planned.telemetry.every_steps {
            0 => "needs telemetry, but telemetry.every_steps is 0; set it to 1 or more".to_owned(),
            every => format!(
                "needs telemetry within the {part}, but telemetry.every_steps is {every}; set it lower, or make the {part} longer"
            ),
        },
        Measured::MissingSignal(name) => missing(planned, name),
        Measured::UnknownSignal => {
            let Quantity::Statistic { signal, .. } = &expectation.quantity else {
                return "is not known".to_owned();
            };
            if !planned.run.mode.is_hil() && !signal.starts_with(DRIVE_PREFIX) {
                return NO_TRUTH.to_owned();
            }
            let of_drive = format!("{DRIVE_PREFIX}{signal}");
            if signals.unit(&of_drive).is_some() {
                return format!("is a signal of the drive; write \"{of_drive}\"");
            }
            let names: Vec<_> = signals.names().collect();
            let known = names.iter().map(|name| &**name);
            format!("is not measured: {}", UnknownName::new("the run", "signal", signal, known))
        }
        Measured::NoTruth | Measured::Value(_) | Measured::Never | Measured::NotMeasured | Measured::NotFinite => {
            format!("has no value: {obstacle}")
        }
    }
}

fn missing(planned: &PlannedRun<'_>, name: &'static str) -> String {
    match name.strip_prefix(DRIVE_PREFIX) {
        Some(signal) => format!(
            "needs the signal {signal} of the drive, which the telemetry of the law {} does not carry; add it to telemetry.signals, \
             or take a law that has it",
            planned.controller.name
        ),
        None if !planned.run.mode.is_hil() => {
            format!("needs the signal {name} of the plant, which {NO_TRUTH}")
        }
        None => format!(
            "needs the signal {name} of the plant, which the model {} does not have; take another metric",
            planned.plant.model.name()
        ),
    }
}
