//! Mutants of samples and torques.

use lashloop_protocol::HostMessage;
use lashloop_protocol::enums::{Outcome, ParameterValue, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{EncoderSample, SetParameter, TorqueAnswer};

use super::{alters_answers, alters_requests, answering, is_result_of, torques};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    alters_answers(
        "answers samples before the handshake",
        "a sample before the handshake is refused",
        |memory, answers| {
            answering(memory, answers, |sample, result| {
                (result.state == State::Boot).then_some(TorqueAnswer {
                    sequence: sample.sequence,
                    torque_nm: 0.0,
                    status: TorqueStatus { state: State::Boot, flags: TorqueFlags::empty() },
                    compute_tenths_us: 0,
                })
            })
        },
    ),
    alters_answers(
        "counts answers from 1",
        "while running a sample gets a torque with its sequence",
        |_, answers| torques(answers, |it| it.sequence = it.sequence.wrapping_add(1)),
    ),
    alters_answers(
        "offers a law it does not have",
        "every law that the drive describes returns a torque",
        |memory, answers| {
            if let Some(HostMessage::SetParameter(SetParameter { index: 0, value: ParameterValue::U32(1) })) =
                memory.request
            {
                memory.number = 1;
            } else if matches!(memory.request, Some(HostMessage::Reset(_))) {
                memory.number = 0;
            }
            let absent = memory.number == 1;
            torques(answers, |it| {
                if absent {
                    it.torque_nm = f32::NAN;
                }
            })
        },
    ),
    alters_answers(
        "takes any first sample",
        "the first sample of a run must carry sequence 0",
        |memory, answers| {
            answering(memory, answers, |sample, result| {
                (result.outcome == Outcome::OutOfSequence).then_some(TorqueAnswer {
                    sequence: sample.sequence,
                    torque_nm: 1.0,
                    status: TorqueStatus { state: State::Running, flags: TorqueFlags::empty() },
                    compute_tenths_us: 0,
                })
            })
        },
    ),
    alters_answers(
        "does not flag repetitions",
        "a repeated sample gets the same torque, flagged REPEATED",
        |_, answers| torques(answers, |it| it.status.flags.remove(TorqueFlags::REPEATED)),
    ),
    alters_answers(
        "answers a repetition anew",
        "a repeated sample gets the same torque, flagged REPEATED",
        |_, answers| {
            torques(answers, |it| {
                if it.status.flags.contains(TorqueFlags::REPEATED) {
                    it.torque_nm *= 0.5;
                }
            })
        },
    ),
    Variant {
        on_request: |memory, request| match request {
            HostMessage::EncoderSample(_) if memory.kept == Some(request) => {
                memory.number += 1;
                vec![request]
            }
            HostMessage::EncoderSample(_) => {
                memory.kept = Some(request);
                vec![request]
            }
            HostMessage::Start(_) => {
                (memory.kept, memory.number) = (None, 0);
                vec![request]
            }
            other => vec![other],
        },
        ..alters_answers(
            "steps at a repetition",
            "a repeated sample makes no control step",
            |memory, answers| {
                let steps = memory.number;
                torques(answers, |it| {
                    if !it.status.flags.contains(TorqueFlags::REPEATED) {
                        it.torque_nm -= 0.001 * steps as f32;
                    }
                })
            },
        )
    },
    alters_answers("does not flag gaps", "a gap is flagged GAP, once", |_, answers| {
        torques(answers, |it| it.status.flags.remove(TorqueFlags::GAP))
    }),
    alters_requests(
        "does not know that sequences wrap",
        "sequence 65535 wraps around to 0",
        |memory, request| match request {
            HostMessage::EncoderSample(sample) => {
                let wraps = sample.sequence == 0 && memory.number == u32::from(u16::MAX);
                memory.number = sample.sequence.into();
                vec![if wraps { EncoderSample { sequence: 1 << 15, ..sample }.into() } else { request }]
            }
            other => vec![other],
        },
    ),
    alters_answers(
        "answers stray samples",
        "a sample older than the last or far ahead of it is refused",
        |memory, answers| {
            answering(memory, answers, |sample, result| {
                (result.outcome == Outcome::OutOfSequence && sample.sequence > 1 << 14).then_some(
                    TorqueAnswer {
                        sequence: sample.sequence,
                        torque_nm: 1.0,
                        status: TorqueStatus { state: State::Running, flags: TorqueFlags::GAP },
                        compute_tenths_us: 0,
                    },
                )
            })
        },
    ),
    alters_answers("steps at a stray sample", "a refused sample makes no control step", |memory, answers| {
        if matches!(memory.request, Some(HostMessage::Start(_))) {
            memory.number = 0;
        }
        if answers.iter().any(is_result_of::<EncoderSample>) {
            memory.number += 1;
        }
        let steps = memory.number;
        torques(answers, |it| it.torque_nm -= 0.001 * steps as f32)
    }),
    alters_answers(
        "starts from where it stopped",
        "a new start resets the controller: equal samples get equal torques",
        |memory, answers| {
            let fresh = matches!(memory.request, Some(HostMessage::Reset(_)));
            memory.number = if fresh { 0 } else { memory.number + 1 };
            let requests = memory.number;
            torques(answers, |it| it.torque_nm -= 1e-4 * requests as f32)
        },
    ),
    alters_answers("pushes in Idle", "a sample gets torque zero in Idle", |_, answers| {
        torques(answers, |it| {
            if it.status.state == State::Idle {
                it.torque_nm = 1.0;
            }
        })
    }),
    alters_answers("pushes in Armed", "a sample gets torque zero in Armed", |_, answers| {
        torques(answers, |it| {
            if it.status.state == State::Armed {
                it.torque_nm = 1.0;
            }
        })
    }),
];
