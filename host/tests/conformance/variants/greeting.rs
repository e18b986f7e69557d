//! Wrong about the greeting.

use lashloop_protocol::enums::Version;
use lashloop_protocol::message::{Arm, Hello, Start, Stop};
use lashloop_protocol::text::Text;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage, PROTOCOL_VERSION};

use super::{each, hears, says};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    hears("stays in Boot", "Hello ends Boot", |_, request| match request {
        HostMessage::Hello(hello) => vec![Hello { protocol_version: 0, ..hello }.into()],
        other => vec![other],
    }),
    says("has no board", "the identity has every field filled in", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::Identity(it) = answer {
                it.board = Text::EMPTY;
                it.firmware = Version { major: 0, minor: 0, patch: 0 };
            }
        })
    }),
    says(
        "tells the first session for ever",
        "the identity carries the session of its Hello",
        |past, answers| {
            each(answers, |answer| {
                if let DriveMessage::Identity(it) = answer {
                    if past.number == 0 {
                        past.number = it.session;
                    }
                    it.session = past.number;
                }
            })
        },
    ),
    Variant {
        hear: |past, request| match request {
            HostMessage::Hello(hello)
                if std::mem::replace(&mut past.number, hello.session) == hello.session =>
            {
                vec![Stop {}.into(), request]
            }
            other => vec![other],
        },
        ..says("stops at every Hello", "the same session again leaves Running", |past, mut answers| {
            if matches!(past.request, Some(HostMessage::Hello(_))) {
                answers.retain(|answer| {
                    let to_stop =
                        matches!(answer, DriveMessage::CommandResult(it) if it.request == Stop::LAYOUT.kind);
                    !to_stop && !matches!(answer, DriveMessage::LineReport(_))
                });
            }
            answers
        })
    },
    Variant {
        // One session for all.
        hear: |_, request| {
            vec![match request {
                HostMessage::Hello(hello) => Hello { session: 1, ..hello }.into(),
                HostMessage::Arm(_) => Arm { session: 1 }.into(),
                HostMessage::Start(_) => Start { session: 1 }.into(),
                other => other,
            }]
        },
        ..says("knows no sessions", "a new session disarms from Running", |past, answers| {
            each(answers, |answer| {
                if let (DriveMessage::Identity(it), Some(HostMessage::Hello(hello))) = (answer, past.request)
                {
                    it.session = hello.session;
                }
            })
        })
    },
    says(
        "keeps a latched fault to itself",
        "a new session leaves a latched fault and is told of it",
        |past, mut answers| {
            if matches!(past.request, Some(HostMessage::Hello(_))) {
                answers.retain(|answer| !matches!(answer, DriveMessage::FaultReport(_)));
            }
            answers
        },
    ),
    hears(
        "takes every version for its own",
        "another version is refused, with the drive's own version in the identity",
        |_, request| match request {
            HostMessage::Hello(hello) => vec![Hello { protocol_version: PROTOCOL_VERSION, ..hello }.into()],
            other => vec![other],
        },
    ),
    hears("opens a session for any version", "a Hello of another version opens no session", |_, request| {
        match request {
            HostMessage::Hello(hello) => {
                vec![Hello { protocol_version: PROTOCOL_VERSION, ..hello }.into(), request]
            }
            other => vec![other],
        }
    }),
];
