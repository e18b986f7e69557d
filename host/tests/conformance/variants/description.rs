//! Drives that describe themselves wrongly.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::HostMessage;
use lashloop_protocol::enums::Outcome;
use lashloop_protocol::text::Text;

use super::{alters_answers, each};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    alters_answers("has no law", "the drive has 1 to 16 laws and at most 32 signals", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::Identity(it) = answer {
                it.law_count = 0;
            }
        })
    }),
    alters_answers(
        "has two laws of one name",
        "names of laws, signals and choices are unique and not empty",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::LawDescription(it) = answer {
                    it.name = Text::new("law");
                }
            })
        },
    ),
    alters_answers(
        "has signals of no law",
        "every parameter and every signal belongs to a law",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::SignalDescription(it) = answer {
                    it.laws = 0;
                }
            })
        },
    ),
    alters_answers(
        "has other names for the choices of controller",
        "controller has the names of the laws as choices",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::ChoiceDescription(it) = answer
                    && it.parameter == 0
                {
                    it.name = Text::new(if it.choice == 0 { "first" } else { "second" });
                }
            })
        },
    ),
    alters_answers(
        "accepts every index of a law",
        "an unknown law, signal or choice is answered with UnknownIndex",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::CommandResult(it) = answer
                    && it.outcome == Outcome::UnknownIndex
                {
                    it.outcome = Outcome::Accepted;
                }
            })
        },
    ),
    alters_answers(
        "renames its laws at a reset",
        "the drive describes itself in Idle as at the start",
        |memory, answers| {
            if matches!(memory.request, Some(HostMessage::Reset(_))) {
                memory.number = 1;
            }
            let renamed = memory.number == 1;
            each(answers, |answer| {
                if let DriveMessage::LawDescription(it) = answer
                    && renamed
                {
                    it.name.push("-2");
                }
            })
        },
    ),
];
