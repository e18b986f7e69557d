//! Wrong about frames and the line.

use std::time::Duration;

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{CommandResult, Stop};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{each, says};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    says("answers damaged frames", "a frame with a flipped bit is not answered", |past, mut answers| {
        if past.damaged {
            let (request, outcome, state) = (Stop::LAYOUT.kind, Outcome::WrongState, State::Idle);
            answers.push(CommandResult { request, outcome, state }.into());
        }
        answers
    }),
    Variant {
        hear: |past, request| {
            // The first good frame after a damaged one is lost.
            if std::mem::take(&mut past.number) == 1 { Vec::new() } else { vec![request] }
        },
        ..says(
            "is slow to come into step",
            "a truncated frame is not answered, and the next one is",
            |past, answers| {
                past.number = u32::from(past.damaged);
                answers
            },
        )
    },
    says(
        "answers only one frame at a time",
        "frames in one write are answered in their order",
        |past, answers| {
            // As if there were no time for the second of several.
            let second = matches!(past.request, Some(HostMessage::GetParameter(it)) if it.index == 1);
            if second { Vec::new() } else { answers }
        },
    ),
    says(
        "says the result before the report",
        "Stop is answered with a LineReport before its result",
        |past, mut answers| {
            if matches!(past.request, Some(HostMessage::Stop(_))) {
                answers.reverse();
            }
            answers
        },
    ),
    says(
        "counts delimiters as damage",
        "the LineReport of a clean run tells of no damage, delimiters alone included",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::LineReport(it) = answer {
                    it.damaged += 5;
                }
            })
        },
    ),
    says("does not count damage", "the LineReport counts damaged and refused frames", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::LineReport(it) = answer {
                it.damaged = 0;
            }
        })
    }),
    says("adds up the damage of all runs", "the LineReport counts each run anew", |past, answers| {
        each(answers, |answer| {
            if let DriveMessage::LineReport(it) = answer {
                past.number += it.damaged;
                it.damaged = past.number;
            }
        })
    }),
    says("falls asleep", "every DescribeParameter is answered within 1 s", |past, answers| {
        past.number +=
            u32::from(matches!(past.request, Some(HostMessage::DescribeParameter(it)) if it.index == 0));
        if past.number == 100 {
            past.number += 1;
            std::thread::sleep(Duration::from_millis(1_100));
        }
        answers
    }),
];
