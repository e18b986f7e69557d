//! Wrong about samples and torques.

use lashloop_protocol::enums::{Outcome, ParameterValue, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{EncoderSample, SetParameter, TorqueAnswer};
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{answering, each, hears, is_result_of, says, telemetry, torques};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    says(
        "answers samples before the greeting",
        "a sample before the greeting is refused",
        |past, answers| {
            answering(past, answers, |sample, result| {
                (result.state == State::Boot).then_some(TorqueAnswer {
                    sequence: sample.sequence,
                    torque_nm: 0.0,
                    status: TorqueStatus { state: State::Boot, flags: TorqueFlags::empty() },
                    compute_tenths_us: 0,
                })
            })
        },
    ),
    says("counts answers from 1", "while running a sample gets a torque with its sequence", |_, answers| {
        torques(answers, |it| it.sequence = it.sequence.wrapping_add(1))
    }),
    says(
        "offers a law it does not have",
        "every controller that is offered gives a torque",
        |past, answers| {
            if let Some(HostMessage::SetParameter(SetParameter { index: 0, value: ParameterValue::U32(3) })) =
                past.request
            {
                past.number = 1;
            } else if matches!(past.request, Some(HostMessage::Reset(_))) {
                past.number = 0;
            }
            let absent = past.number == 1;
            torques(answers, |it| {
                if absent {
                    it.torque_nm = f32::NAN;
                }
            })
        },
    ),
    says("takes any first sample", "the first sample of a run must carry sequence 0", |past, answers| {
        answering(past, answers, |sample, result| {
            (result.outcome == Outcome::OutOfSequence).then_some(TorqueAnswer {
                sequence: sample.sequence,
                torque_nm: 1.0,
                status: TorqueStatus { state: State::Running, flags: TorqueFlags::empty() },
                compute_tenths_us: 0,
            })
        })
    }),
    says(
        "does not flag repetitions",
        "a repeated sample gets the same torque, flagged REPEATED",
        |_, answers| torques(answers, |it| it.status.flags.remove(TorqueFlags::REPEATED)),
    ),
    says(
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
        hear: |past, request| match request {
            HostMessage::EncoderSample(_) if past.kept == Some(request) => {
                past.number += 1;
                vec![request]
            }
            HostMessage::EncoderSample(_) => {
                past.kept = Some(request);
                vec![request]
            }
            HostMessage::Start(_) => {
                (past.kept, past.number) = (None, 0);
                vec![request]
            }
            other => vec![other],
        },
        ..says("steps at a repetition", "a repeated sample makes no control step", |past, answers| {
            let steps = past.number;
            torques(answers, |it| {
                if !it.status.flags.contains(TorqueFlags::REPEATED) {
                    it.torque_nm -= 0.001 * steps as f32;
                }
            })
        })
    },
    says("does not flag gaps", "a gap is flagged GAP, once", |_, answers| {
        torques(answers, |it| it.status.flags.remove(TorqueFlags::GAP))
    }),
    hears(
        "does not know that sequences wrap",
        "after sequence 65535 comes 0",
        |past, request| match request {
            HostMessage::EncoderSample(sample) => {
                let wraps = sample.sequence == 0 && past.number == u32::from(u16::MAX);
                past.number = sample.sequence.into();
                vec![if wraps { EncoderSample { sequence: 1 << 15, ..sample }.into() } else { request }]
            }
            other => vec![other],
        },
    ),
    says(
        "answers stray samples",
        "a sample older than the last or far ahead of it is refused",
        |past, answers| {
            answering(past, answers, |sample, result| {
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
    says("steps at a stray sample", "a stray sample makes no control step", |past, answers| {
        if matches!(past.request, Some(HostMessage::Start(_))) {
            past.number = 0;
        }
        if answers.iter().any(is_result_of::<EncoderSample>) {
            past.number += 1;
        }
        let steps = past.number;
        torques(answers, |it| it.torque_nm -= 0.001 * steps as f32)
    }),
    says(
        "starts from where it stopped",
        "a new start begins anew: the same samples get the same torques",
        |past, answers| {
            let fresh = matches!(past.request, Some(HostMessage::Reset(_)));
            past.number = if fresh { 0 } else { past.number + 1 };
            let requests = past.number;
            torques(answers, |it| it.torque_nm -= 1e-4 * requests as f32)
        },
    ),
    says(
        "sends telemetry before the torque",
        "telemetry follows the torque of every n-th sample",
        |_, mut answers| {
            answers.sort_by_key(|answer| !matches!(answer, DriveMessage::Telemetry(_)));
            answers
        },
    ),
    says("sends telemetry with every torque", "telemetry_every = 0 means no telemetry", |_, mut answers| {
        if let Some(DriveMessage::TorqueAnswer(it)) = answers.first().copied()
            && answers.len() == 1
        {
            answers.push(telemetry(it).into());
        }
        answers
    }),
    says("tells the limited torque", "telemetry has the torque asked for before the limit", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::Telemetry(it) = answer {
                it.requested_torque_nm = 0.0;
            }
        })
    }),
    says("pushes in Idle", "a sample gets torque zero in Idle", |_, answers| {
        torques(answers, |it| {
            if it.status.state == State::Idle {
                it.torque_nm = 1.0;
            }
        })
    }),
    says("pushes in Armed", "a sample gets torque zero in Armed", |_, answers| {
        torques(answers, |it| {
            if it.status.state == State::Armed {
                it.torque_nm = 1.0;
            }
        })
    }),
];
