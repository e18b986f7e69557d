//! Wrong about encoders.

use lashloop_protocol::enums::{Outcome, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{Arm, EncoderSample, TorqueAnswer};
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage};

use super::{answering, each, hears, is_result_of, says, torques};
use crate::mutants::{Past, Variant};

const WRAPS: &str = "an encoder that wraps around goes on where it was";
const FAR: &str = "an encoder may go further than half its range from its first reading";
const LONGEST_GAP: &str = "a gap is taken as long as positions can be told apart, and no longer";

pub const VARIANTS: &[Variant] = &[
    hears(
        "believes any motor encoder",
        "a motor encoder that jumps is a fault",
        |_, request| match request {
            HostMessage::EncoderSample(sample) if is_fast(sample.motor_counts) => {
                vec![EncoderSample { motor_counts: EncoderCounts::default(), ..sample }.into()]
            }
            other => vec![other],
        },
    ),
    hears("believes any load encoder", "a load encoder that jumps is a fault", |_, request| match request {
        HostMessage::EncoderSample(sample) if is_fast(sample.load_counts) => {
            vec![EncoderSample { load_counts: EncoderCounts::default(), ..sample }.into()]
        }
        other => vec![other],
    }),
    hears(
        "believes no encoder",
        "an encoder within its speed limit is believed",
        |_, request| match request {
            HostMessage::EncoderSample(sample) if sample.motor_counts.get().unsigned_abs() > 300 => {
                vec![EncoderSample { motor_counts: EncoderCounts::wrapping(1 << 22), ..sample }.into()]
            }
            other => vec![other],
        },
    ),
    hears("does not know that counters wrap", WRAPS, |_, request| match request {
        HostMessage::EncoderSample(sample) if sample.motor_counts == EncoderCounts::MIN => {
            vec![EncoderSample { motor_counts: EncoderCounts::default(), ..sample }.into()]
        }
        other => vec![other],
    }),
    // Their speed checks know of the wrap: those are the real drive's.
    Variant {
        hear: |past, request| follow(past, request, |sample| sample.motor_counts),
        ..says("gives its law the motor's raw readings", WRAPS, |past, answers| {
            let (_, now) = past.counts;
            mistaking(answers, now)
        })
    },
    Variant {
        hear: |past, request| follow(past, request, |sample| sample.load_counts),
        ..says("gives its law the load's raw readings", WRAPS, |past, answers| {
            let (_, now) = past.counts;
            mistaking(answers, now)
        })
    },
    Variant {
        hear: |past, request| follow(past, request, |sample| sample.motor_counts),
        ..says("takes the motor's way from its first reading alone", FAR, |past, answers| {
            let (first, now) = past.counts;
            mistaking(answers, now - first)
        })
    },
    Variant {
        hear: |past, request| follow(past, request, |sample| sample.load_counts),
        ..says("takes the load's way from its first reading alone", FAR, |past, answers| {
            let (first, now) = past.counts;
            mistaking(answers, now - first)
        })
    },
    says("takes a gap of 1000 periods whatever its encoders are", LONGEST_GAP, |past, answers| {
        match (past.request, past.kept) {
            (Some(HostMessage::Start(_)), _) => past.kept = None,
            (Some(it @ HostMessage::EncoderSample(_)), _)
                if !answers.iter().any(is_result_of::<EncoderSample>) =>
            {
                past.kept = Some(it);
            }
            (_, Some(HostMessage::EncoderSample(last))) => {
                return answering(past, answers, |sample, result| {
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
    }),
    hears("takes no gap of hundreds of periods", LONGEST_GAP, |past, request| match request {
        HostMessage::EncoderSample(sample) => {
            let ahead = sample.sequence.wrapping_sub(past.number as u16);
            let far = (300..=900).contains(&ahead);
            if ahead < 300 {
                past.number = sample.sequence.into();
            }
            vec![if far { EncoderSample { sequence: 1 << 15, ..sample }.into() } else { request }]
        }
        HostMessage::Start(_) => {
            past.number = 0;
            vec![request]
        }
        other => vec![other],
    }),
    says(
        "arms whatever the motor's encoder is",
        "Arm is refused if no period tells positions of the motor apart",
        |_, answers| arming_anyway(answers, "motor_speed_limit_rad_s"),
    ),
    says(
        "arms whatever the load's encoder is",
        "Arm is refused if no period tells positions of the load apart",
        |_, answers| arming_anyway(answers, "load_speed_limit_rad_s"),
    ),
    says(
        "does not say what is inconsistent",
        "Arm is refused if no period tells positions of the motor apart",
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
    past: &mut Past,
    request: HostMessage,
    reading: fn(&EncoderSample) -> EncoderCounts,
) -> Vec<HostMessage> {
    match request {
        HostMessage::EncoderSample(sample) => {
            let read = reading(&sample);
            past.counts = match past.kept {
                Some(HostMessage::EncoderSample(before)) => {
                    let (first, now) = past.counts;
                    (first, now + i64::from(read.wrapping_sub(reading(&before))))
                }
                _ => (read.get().into(), read.get().into()),
            };
            past.kept = Some(request);
        }
        HostMessage::Start(_) => (past.kept, past.counts) = (None, (0, 0)),
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
