//! Mutants of parameters.

use lashloop_protocol::enums::{Outcome, ParameterValue};
use lashloop_protocol::message::{GetParameter, SetParameter};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{alters_answers, alters_requests, describing, each, reporting};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    alters_answers("has lost its watchdog", "the drive has every required parameter", |_, answers| {
        describing(answers, |it| {
            if it.name.as_str() == "watchdog_us" {
                it.name = Text::new("dog_us");
            }
        })
    }),
    alters_answers("has one name for all", "every parameter name is unique", |_, answers| {
        describing(answers, |it| it.name = Text::new("gain"))
    }),
    alters_answers(
        "has ranges of another type",
        "default, minimum and maximum have one type",
        |_, answers| describing(answers, |it| it.min = ParameterValue::U32(0)),
    ),
    alters_answers("has defaults out of range", "every default lies in its range", |_, answers| {
        describing(answers, |it| it.default = ParameterValue::F32(f32::MAX))
    }),
    alters_answers(
        "has other defaults than it describes",
        "after a reset every parameter has its default",
        |_, answers| describing(answers, |it| it.default = it.min),
    ),
    alters_answers(
        "has wider ranges than it takes",
        "every parameter accepts its minimum and maximum and reads them back",
        |_, answers| {
            describing(answers, |it| {
                if let ParameterValue::F32(max) = &mut it.max {
                    *max *= 2.0;
                }
            })
        },
    ),
    Variant {
        on_request: |_, request| match request {
            // Any other request with one answer of its own.
            HostMessage::SetParameter(set) => {
                vec![GetParameter { index: set.index }.into()]
            }
            other => vec![other],
        },
        ..alters_answers(
            "reads back the request in place of its value",
            "every parameter accepts its minimum and maximum and reads them back",
            |memory, answers| reporting(memory, answers, |it, set| it.value = set.value),
        )
    },
    alters_answers(
        "takes what is out of range",
        "a value out of range is refused and changes nothing",
        |memory, answers| {
            reporting(memory, answers, |it, set| {
                if it.outcome == Outcome::OutOfRange {
                    (it.outcome, it.value) = (Outcome::Accepted, set.value);
                }
            })
        },
    ),
    alters_requests(
        "converts types",
        "a value of the wrong type is refused and changes nothing",
        |_, request| match request {
            HostMessage::SetParameter(SetParameter { index, value: ParameterValue::U32(value) })
                if index > 8 =>
            {
                vec![SetParameter { index, value: ParameterValue::F32(value as f32) }.into()]
            }
            other => vec![other],
        },
    ),
    alters_answers("knows every index", "an unknown parameter index is refused", |_, answers| {
        each(answers, |answer| match answer {
            DriveMessage::ParameterReport(it) if it.outcome == Outcome::UnknownIndex => {
                it.outcome = Outcome::Accepted;
            }
            _ => {}
        })
    }),
    alters_answers(
        "keeps a parameter through Reset",
        "a reset restores the default of a changed parameter",
        |memory, answers| {
            if matches!(memory.request, Some(HostMessage::Reset(_))) {
                memory.number += 1;
            }
            // Wrong from the second value on that is read after a set of the torque limit.
            if let Some(HostMessage::SetParameter(SetParameter { index: 5, .. })) = memory.request {
                memory.kept = memory.request;
            }
            let kept = memory.kept;
            each(answers, |answer| match (answer, kept) {
                (DriveMessage::ParameterReport(it), Some(HostMessage::SetParameter(set)))
                    if it.index == 5 =>
                {
                    it.value = set.value;
                }
                _ => {}
            })
        },
    ),
    alters_answers(
        "has an identity of its own",
        "the identity follows the period and encoder parameters",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::Identity(it) = answer {
                    it.period_us = 1_000;
                }
            })
        },
    ),
    alters_answers(
        "takes everything while running",
        "while running a live parameter is accepted and any other refused",
        |memory, answers| reporting(memory, answers, |it, _| it.outcome = Outcome::Accepted),
    ),
];
