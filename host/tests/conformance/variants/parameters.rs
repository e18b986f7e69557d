//! Wrong about parameters.

use lashloop_protocol::enums::{Outcome, ParameterValue};
use lashloop_protocol::message::{GetParameter, SetParameter};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{describing, each, hears, reporting, says};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    says("has lost its watchdog", "the drive has the parameters that every bench sets", |_, answers| {
        describing(answers, |it| {
            if it.name.as_str() == "watchdog_us" {
                it.name = Text::new("dog_us");
            }
        })
    }),
    says("has one name for all", "every parameter has a name of its own", |_, answers| {
        describing(answers, |it| it.name = Text::new("gain"))
    }),
    says(
        "has ranges of another type",
        "default, smallest and largest value are of one type",
        |_, answers| describing(answers, |it| it.min = ParameterValue::U32(0)),
    ),
    says("has defaults out of range", "every default lies in its range", |_, answers| {
        describing(answers, |it| it.default = ParameterValue::F32(f32::MAX))
    }),
    says("has other defaults than it says", "after a reset every parameter has its default", |_, answers| {
        describing(answers, |it| it.default = it.min)
    }),
    says(
        "has wider ranges than it takes",
        "every parameter takes its smallest and its largest value and reads it back",
        |_, answers| {
            describing(answers, |it| {
                if let ParameterValue::F32(max) = &mut it.max {
                    *max *= 2.0;
                }
            })
        },
    ),
    Variant {
        hear: |_, request| match request {
            // Any other request with one answer of its own.
            HostMessage::SetParameter(set) => {
                vec![GetParameter { index: set.index }.into()]
            }
            other => vec![other],
        },
        ..says(
            "reads back what it was told instead of what it has",
            "every parameter takes its smallest and its largest value and reads it back",
            |past, answers| reporting(past, answers, |it, set| it.value = set.value),
        )
    },
    says(
        "takes what is out of range",
        "a value out of range is refused and changes nothing",
        |past, answers| {
            reporting(past, answers, |it, set| {
                if it.outcome == Outcome::OutOfRange {
                    (it.outcome, it.value) = (Outcome::Accepted, set.value);
                }
            })
        },
    ),
    hears("converts types", "a value of the wrong type is refused and changes nothing", |_, request| {
        match request {
            HostMessage::SetParameter(SetParameter { index, value: ParameterValue::U32(value) })
                if index > 8 =>
            {
                vec![SetParameter { index, value: ParameterValue::F32(value as f32) }.into()]
            }
            other => vec![other],
        }
    }),
    says("knows every index", "an index that no parameter has is refused", |_, answers| {
        each(answers, |answer| match answer {
            DriveMessage::ParameterReport(it) if it.outcome == Outcome::UnknownParameter => {
                it.outcome = Outcome::Accepted;
            }
            _ => {}
        })
    }),
    says(
        "keeps a parameter through Reset",
        "a reset brings back the default of what was set",
        |past, answers| {
            if matches!(past.request, Some(HostMessage::Reset(_))) {
                past.number += 1;
            }
            // Wrong from the second value on that is read after a set of the torque limit.
            if let Some(HostMessage::SetParameter(SetParameter { index: 4, .. })) = past.request {
                past.kept = past.request;
            }
            let kept = past.kept;
            each(answers, |answer| match (answer, kept) {
                (DriveMessage::ParameterReport(it), Some(HostMessage::SetParameter(set)))
                    if it.index == 4 =>
                {
                    it.value = set.value;
                }
                _ => {}
            })
        },
    ),
    says(
        "has an identity of its own",
        "the identity has the period and the encoders that were set",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::Identity(it) = answer {
                    it.period_us = 1_000;
                }
            })
        },
    ),
    says(
        "takes everything while running",
        "while running a parameter is taken if it is live and refused if not",
        |past, answers| reporting(past, answers, |it, _| it.outcome = Outcome::Accepted),
    ),
];
