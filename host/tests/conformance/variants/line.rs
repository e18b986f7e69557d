//! Mutants of frames and the line.

use std::time::Duration;

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{CommandResult, Stop};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{alters_answers, each};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    alters_answers(
        "answers damaged frames",
        "a frame with a flipped bit is not answered",
        |memory, mut answers| {
            if memory.damaged {
                let (request, outcome, state) = (Stop::LAYOUT.kind, Outcome::WrongState, State::Idle);
                answers.push(CommandResult { request, outcome, state }.into());
            }
            answers
        },
    ),
    Variant {
        on_request: |memory, request| {
            // The first good frame after a damaged one is lost.
            if std::mem::take(&mut memory.number) == 1 { Vec::new() } else { vec![request] }
        },
        ..alters_answers(
            "is slow to come into step",
            "a truncated frame is not answered, and the next one is",
            |memory, answers| {
                memory.number = u32::from(memory.damaged);
                answers
            },
        )
    },
    alters_answers(
        "answers only one frame at a time",
        "frames in one write are answered in their order",
        |memory, answers| {
            // As if there were no time for the second of several.
            let second = matches!(memory.request, Some(HostMessage::GetParameter(it)) if it.index == 1);
            if second { Vec::new() } else { answers }
        },
    ),
    alters_answers(
        "sends the result before the report",
        "Stop is answered with a LineReport before its result",
        |memory, mut answers| {
            if matches!(memory.request, Some(HostMessage::Stop(_))) {
                answers.reverse();
            }
            answers
        },
    ),
    alters_answers(
        "counts delimiters as damage",
        "the LineReport of a clean run counts no damage, with idle delimiters",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::LineReport(it) = answer {
                    it.damaged += 5;
                }
            })
        },
    ),
    alters_answers(
        "does not count damage",
        "the LineReport counts damaged and refused frames",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::LineReport(it) = answer {
                    it.damaged = 0;
                }
            })
        },
    ),
    alters_answers(
        "adds up the damage of all runs",
        "the LineReport counts each run from zero",
        |memory, answers| {
            each(answers, |answer| {
                if let DriveMessage::LineReport(it) = answer {
                    memory.number += it.damaged;
                    it.damaged = memory.number;
                }
            })
        },
    ),
    alters_answers("falls asleep", "every DescribeParameter is answered within 1 s", |memory, answers| {
        memory.number +=
            u32::from(matches!(memory.request, Some(HostMessage::DescribeParameter(it)) if it.index == 0));
        if memory.number == 40 {
            memory.number += 1;
            return Vec::new();
        }
        answers
    }),
];
