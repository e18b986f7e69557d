//! Wrong about the transitions between states.

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{Arm, EmergencyStop, Start, Stop};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{each, hears, is_result_of, says};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    hears("arms for any session", "Arm of another session is refused", |past, request| match request {
        HostMessage::Hello(hello) => {
            past.number = hello.session;
            vec![request]
        }
        HostMessage::Arm(_) => vec![Arm { session: past.number }.into()],
        other => vec![other],
    }),
    hears("starts for any session", "Start of another session is refused", |past, request| match request {
        HostMessage::Hello(hello) => {
            past.number = hello.session;
            vec![request]
        }
        HostMessage::Start(_) => vec![Start { session: past.number }.into()],
        other => vec![other],
    }),
    Variant {
        hear: |past, request| match request {
            HostMessage::Hello(hello) => {
                past.number = hello.session;
                vec![request]
            }
            HostMessage::Start(start) => vec![Arm { session: start.session }.into(), request],
            other => vec![other],
        },
        ..says(
            "starts without having been armed",
            "Start is refused in Idle as WrongState",
            |past, mut answers| {
                if matches!(past.request, Some(HostMessage::Start(_))) {
                    answers.retain(|answer| !is_result_of::<Arm>(answer));
                }
                answers
            },
        )
    },
    Variant {
        hear: |_, request| match request {
            HostMessage::EmergencyStop(_) => vec![Stop {}.into()],
            other => vec![other],
        },
        ..says(
            "takes EmergencyStop for Stop",
            "EmergencyStop leads from Running to Faulted",
            |past, answers| {
                let emergency = matches!(past.request, Some(HostMessage::EmergencyStop(_)));
                each(answers, |answer| {
                    if let (DriveMessage::CommandResult(it), true) = (answer, emergency) {
                        it.request = EmergencyStop::LAYOUT.kind;
                    }
                })
            },
        )
    },
    says("says that every refusal was done", "Arm is refused in Boot as WrongSession", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::CommandResult(it) = answer {
                it.outcome = Outcome::Accepted;
            }
        })
    }),
    says("never says Idle", "Stop leads from Running to Idle", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::CommandResult(it) = answer
                && it.state == State::Idle
            {
                it.state = State::Armed;
            }
        })
    }),
    says("never says Armed", "Arm leads from Idle to Armed", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::CommandResult(it) = answer
                && it.state == State::Armed
            {
                it.state = State::Idle;
            }
        })
    }),
    says("never says Running", "Start leads from Armed to Running", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::CommandResult(it) = answer
                && it.state == State::Running
            {
                it.state = State::Armed;
            }
        })
    }),
    says(
        "clears faults to Idle without a greeting",
        "a fault cleared before the greeting leads back to Boot",
        |past, answers| {
            let cleared = matches!(past.request, Some(HostMessage::ClearFault(_)));
            each(answers, |answer| {
                if let (DriveMessage::CommandResult(it), true) = (answer, cleared) {
                    it.state = State::Idle;
                }
            })
        },
    ),
];
