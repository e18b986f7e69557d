//! Wrong about encoders.

use lashloop_protocol::enums::{Outcome, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{Arm, EncoderSample, TorqueAnswer};
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage};

use super::{alters_answers, alters_requests, answering, each, is_result_of, torques};
use crate::mutants::{Memory, Variant};

const WRAPS: &str = "an encoder continues through its wraparound";
const FAR: &str = "an encoder may travel more than half its range from its first reading";
const LONGEST_GAP: &str = "a gap is accepted up to the longest unambiguous one";

pub const VARIANTS: &[Variant] = &[
    alters_requests("believes any motor encoder", "a motor encoder that jumps is a fault", |_, request| {
        match request {
            HostMessage::EncoderSample(sample) if is_fast(sample.motor_counts) => {
                vec![EncoderSample { motor_counts: EncoderCounts::default(), ..sample }.into()]
            }
            other => vec![other],
        }
    }),
    alters_requests("believes any load encoder", "a load encoder that jumps is a fault", |_, request| {
        match request {
            HostMessage::EncoderSample(sample) if is_fast(sample.load_counts) => {
                vec![EncoderSample { load_counts: EncoderCounts::default(), ..sample }.into()]
            }
            other => vec![other],
        }
    }),
    alters_requests("believes no encoder", "an encoder within its speed limit is accepted", |_, request| {
        match request {
            HostMessage::EncoderSample(sample) if sample.motor_counts.get().unsigned_abs() > 300 => {
                vec![EncoderSample { motor_counts: EncoderCounts::wrapping(1 << 22), ..sample }.into()]
            }
            other => vec![other],
        }
    }),
    alters_requests("does not know that counters wrap", WRAPS, |_, request| match request {
        HostMessage::EncoderSample(sample) if sample.motor_counts == EncoderCounts::MIN => {
            vec![EncoderSample { motor_counts: EncoderCounts::default(), ..sample }.into()]
        }
        other => vec![other],
    }),
    // Their speed checks know of the wrap: those are the real drive's.
    Variant {
        on_request: |memory, request| follow(memory, request, |sample| sample.motor_counts),
        ..alters_answers("gives its law the motor's raw readings", WRAPS, |memory, answers| {
            let (_, now) = memory.counts;
            mistaking(answers, now)
        })
    },
    Variant {
        on_request: |memory, request| follow(memory, request, |sample| sample.load_counts),
        ..alters_answers("gives its law the load's raw readings", WRAPS, |memory, answers| {
            let (_, now) = memory.counts;
            mistaking(answers, now)
        })
    },
    Variant {
        on_request: |memory, request| follow(memory, request, |sample| sample.motor_counts),
        ..alters_answers("takes the motor's way from its first reading alone", FAR, |memory, answers| {
            let (first, now) = memory.counts;
            mistaking(answers, now - first)
        })
    },
    Variant {
        on_request: |memory, request| follow(memory, request, |sample| sample.load_counts),
        ..alters_answers("takes the load's way from its first reading alone", FAR, |memory, answers| {
            let (first, now) = memory.counts;
            mistaking(answers, now - first)
        })
    },
    alters_answers(
        "takes a gap of 1000 periods whatever its encoders are",
        LONGEST_GAP,
        |memory, answers| {
            match (memory.request, memory.kept) {
                (Some(HostMessage::Start(_)), _) => memory.kept = None,
                (Some(it @ HostMessage::EncoderSample(_)), _)
                    if !answers.iter().any(is_result_of::<EncoderSample>) =>
                {
                    memory.kept = Some(it);
                }
                (_, Some(HostMessage::EncoderSample(last))) => {
                    return answering(memory, answers, |sample, result| {
                        let ahead = sample.sequence.wrapping_sub(last.sequence);
                        (result.outcome == Outcome::OutOfSequence && (1..=1000).contains(&ahead)).then_some(
                            TorqueAnswer {
                                sequence: sample.sequence,
                                torque_nm: 1.0,
                                status: TorqueStatus { state: State::Running, flags: TorqueFlags::GAP },
                                compute_tenths_us: 0,
                            },
                        )
                    });
                }
                _ => {}
            }
            answers
        },
    ),
    alters_requests("takes no gap of hundreds of periods", LONGEST_GAP, |memory, request| match request {
        HostMessage::EncoderSample(sample) => {
            let ahead = sample.sequence.wrapping_sub(memory.number as u16);
            let far = (300..=900).contains(&ahead);
            if ahead < 300 {
                memory.number = sample.sequence.into();
            }
            vec![if far { EncoderSample { sequence: 1 << 15, ..sample }.into() } else { request }]
        }
        HostMessage::Start(_) => {
            memory.number = 0;
            vec![request]
        }
        other => vec![other],
    }),
    alters_answers(
        "arms whatever the motor's encoder is",
        "Arm is refused if one period leaves the position of the motor ambiguous",
        |_, answers| arming_anyway(answers, "motor_speed_limit_rad_s"),
    ),
    alters_answers(
        "arms whatever the load's encoder is",
        "Arm is refused if one period leaves the position of the load ambiguous",
        |_, answers| arming_anyway(answers, "load_speed_limit_rad_s"),
    ),
    alters_answers(
        "does not say what is inconsistent",
        "Arm is refused if one period leaves the position of the motor ambiguous",
        |_, mut answers| {
            if answers.iter().any(is_inconsistent) {
                answers.retain(|answer| !matches!(answer, DriveMessage::Log(_)));
            }
            answers
        },
    ),
];

/// Whether a period is too short for an encoder to get from zero to here.
pub fn is_fast(counts: EncoderCounts) -> bool {
    counts.get().unsigned_abs() > 700
}

/// Keeps account of where an encoder stands, and tells the drive everything.
fn follow(
    memory: &mut Memory,
    request: HostMessage,
    reading: fn(&EncoderSample) -> EncoderCounts,
) -> Vec<HostMessage> {
    match request {
        HostMessage::EncoderSample(sample) => {
            let read = reading(&sample);
            memory.counts = match memory.kept {
                Some(HostMessage::EncoderSample(before)) => {
                    let (first, now) = memory.counts;
                    (first, now + i64::from(read.wrapping_sub(reading(&before))))
                }
                _ => (read.get().into(), read.get().into()),
            };
            memory.kept = Some(request);
        }
        HostMessage::Start(_) => (memory.kept, memory.counts) = (None, (0, 0)),
        _ => {}
    }
    vec![request]
}

/// The torques of a law that has this number of counts in 24 bits. Where it does not fit, the law sees the encoder on
/// the other side of zero and pushes the other way.
fn mistaking(answers: Vec<DriveMessage>, counts: i64) -> Vec<DriveMessage> {
    let fits = i64::from(EncoderCounts::wrapping(counts).get()) == counts;
    torques(answers, |it| {
        if !fits {
            it.torque_nm = -it.torque_nm;
        }
    })
}

fn is_inconsistent(answer: &DriveMessage) -> bool {
    matches!(answer, DriveMessage::CommandResult(it) if it.outcome == Outcome::Inconsistent)
}

/// Answers an `Arm` that was refused because of this parameter as if it had been done.
fn arming_anyway(mut answers: Vec<DriveMessage>, parameter: &str) -> Vec<DriveMessage> {
    let why = |answer: &DriveMessage| matches!(answer, DriveMessage::Log(it) if it.text.as_str().starts_with(parameter));
    if !(answers.iter().any(is_result_of::<Arm>) && answers.iter().any(why)) {
        return answers;
    }
    answers.retain(|answer| !why(answer));
    each(answers, |answer| {
        if let DriveMessage::CommandResult(it) = answer {
            (it.outcome, it.state) = (Outcome::Accepted, State::Armed);
        }
    })
}
