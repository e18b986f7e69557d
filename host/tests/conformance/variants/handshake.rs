//! Wrong about the greeting.

use lashloop_protocol::enums::Version;
use lashloop_protocol::message::{Arm, Hello, Start, Stop};
use lashloop_protocol::text::Text;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage, PROTOCOL_VERSION};

use super::{alters_answers, alters_requests, each};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    alters_requests("stays in Boot", "Hello ends Boot", |_, request| match request {
        HostMessage::Hello(hello) => vec![Hello { protocol_version: 0, ..hello }.into()],
        other => vec![other],
    }),
    alters_answers("has no board", "the identity has every field filled in", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::Identity(it) = answer {
                it.board = Text::EMPTY;
                it.firmware = Version { major: 0, minor: 0, patch: 0 };
            }
        })
    }),
    alters_answers(
        "tells the first session for ever",
        "the identity carries the session of its Hello",
        |memory, answers| {
            each(answers, |answer| {
                if let DriveMessage::Identity(it) = answer {
                    if memory.number == 0 {
                        memory.number = it.session;
                    }
                    it.session = memory.number;
                }
            })
        },
    ),
    Variant {
        on_request: |memory, request| match request {
            HostMessage::Hello(hello)
                if std::mem::replace(&mut memory.number, hello.session) == hello.session =>
            {
                vec![Stop {}.into(), request]
            }
            other => vec![other],
        },
        ..alters_answers(
            "stops at every Hello",
            "the same session again leaves Running",
            |memory, mut answers| {
                if matches!(memory.request, Some(HostMessage::Hello(_))) {
                    answers.retain(|answer| {
                    let to_stop =
                        matches!(answer, DriveMessage::CommandResult(it) if it.request == Stop::LAYOUT.kind);
                    !to_stop && !matches!(answer, DriveMessage::LineReport(_))
                });
                }
                answers
            },
        )
    },
    Variant {
        // One session for all.
        on_request: |_, request| {
            vec![match request {
                HostMessage::Hello(hello) => Hello { session: 1, ..hello }.into(),
                HostMessage::Arm(_) => Arm { session: 1 }.into(),
                HostMessage::Start(_) => Start { session: 1 }.into(),
                other => other,
            }]
        },
        ..alters_answers("knows no sessions", "a new session disarms from Running", |memory, answers| {
            each(answers, |answer| {
                if let (DriveMessage::Identity(it), Some(HostMessage::Hello(hello))) =
                    (answer, memory.request)
                {
                    it.session = hello.session;
                }
            })
        })
    },
    alters_answers(
        "keeps a latched fault to itself",
        "a new session keeps a latched fault and receives its report",
        |memory, mut answers| {
            if matches!(memory.request, Some(HostMessage::Hello(_))) {
                answers.retain(|answer| !matches!(answer, DriveMessage::FaultReport(_)));
            }
            answers
        },
    ),
    alters_requests(
        "takes every version for its own",
        "another version is refused, and the identity carries the drive's own",
        |_, request| match request {
            HostMessage::Hello(hello) => vec![Hello { protocol_version: PROTOCOL_VERSION, ..hello }.into()],
            other => vec![other],
        },
    ),
    alters_requests(
        "opens a session for any version",
        "a Hello of another version opens no session",
        |_, request| match request {
            HostMessage::Hello(hello) => {
                vec![Hello { protocol_version: PROTOCOL_VERSION, ..hello }.into(), request]
            }
            other => vec![other],
        },
    ),
];
