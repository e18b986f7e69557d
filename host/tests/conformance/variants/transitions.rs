//! Wrong about the transitions between states.

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{Arm, EmergencyStop, Start, Stop};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{alters_answers, alters_requests, each, is_result_of};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    alters_requests("arms for any session", "Arm of another session is refused", |memory, request| {
        match request {
            HostMessage::Hello(hello) => {
                memory.number = hello.session;
                vec![request]
            }
            HostMessage::Arm(_) => vec![Arm { session: memory.number }.into()],
            other => vec![other],
        }
    }),
    alters_requests("starts for any session", "Start of another session is refused", |memory, request| {
        match request {
            HostMessage::Hello(hello) => {
                memory.number = hello.session;
                vec![request]
            }
            HostMessage::Start(_) => vec![Start { session: memory.number }.into()],
            other => vec![other],
        }
    }),
    Variant {
        on_request: |memory, request| match request {
            HostMessage::Hello(hello) => {
                memory.number = hello.session;
                vec![request]
            }
            HostMessage::Start(start) => vec![Arm { session: start.session }.into(), request],
            other => vec![other],
        },
        ..alters_answers(
            "starts without having been armed",
            "Start is refused in Idle as WrongState",
            |memory, mut answers| {
                if matches!(memory.request, Some(HostMessage::Start(_))) {
                    answers.retain(|answer| !is_result_of::<Arm>(answer));
                }
                answers
            },
        )
    },
    Variant {
        on_request: |_, request| match request {
            HostMessage::EmergencyStop(_) => vec![Stop {}.into()],
            other => vec![other],
        },
        ..alters_answers(
            "takes EmergencyStop for Stop",
            "EmergencyStop leads from Running to Faulted",
            |memory, answers| {
                let emergency = matches!(memory.request, Some(HostMessage::EmergencyStop(_)));
                each(answers, |answer| {
                    if let (DriveMessage::CommandResult(it), true) = (answer, emergency) {
                        it.request = EmergencyStop::LAYOUT.kind;
                    }
                })
            },
        )
    },
    alters_answers(
        "says that every refusal was done",
        "Arm is refused in Boot as WrongSession",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::CommandResult(it) = answer {
                    it.outcome = Outcome::Accepted;
                }
            })
        },
    ),
    alters_answers("never says Idle", "Stop leads from Running to Idle", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::CommandResult(it) = answer
                && it.state == State::Idle
            {
                it.state = State::Armed;
            }
        })
    }),
    alters_answers("never says Armed", "Arm leads from Idle to Armed", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::CommandResult(it) = answer
                && it.state == State::Armed
            {
                it.state = State::Idle;
            }
        })
    }),
    alters_answers("never says Running", "Start leads from Armed to Running", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::CommandResult(it) = answer
                && it.state == State::Running
            {
                it.state = State::Armed;
            }
        })
    }),
    alters_answers(
        "clears faults to Idle without a greeting",
        "a fault cleared before the handshake leads back to Boot",
        |memory, answers| {
            let cleared = matches!(memory.request, Some(HostMessage::ClearFault(_)));
            each(answers, |answer| {
                if let (DriveMessage::CommandResult(it), true) = (answer, cleared) {
                    it.state = State::Idle;
                }
            })
        },
    ),
];
