//! Drives that break one rule each, and the check that has to find out.

use std::time::Duration;

use lashloop_protocol::message::{
    Arm, CommandResult, EncoderSample, Hello, ParameterReport, SetParameter, Start, Stop, Telemetry,
    TorqueAnswer,
};
use lashloop_protocol::vocabulary::{FaultCode, Outcome, ParameterValue, State, TorqueFlags, Version};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage, PROTOCOL_VERSION};

use crate::altered::{Past, Variant};

/// Wrong in what it hears.
const fn hears(
    does: &'static str,
    caught_by: &'static str,
    hear: fn(&mut Past, HostMessage) -> Vec<HostMessage>,
) -> Variant {
    Variant { does, caught_by, hear, ..Variant::FAITHFUL }
}

/// Wrong in what it says.
const fn says(
    does: &'static str,
    caught_by: &'static str,
    say: fn(&mut Past, Vec<DriveMessage>) -> Vec<DriveMessage>,
) -> Variant {
    Variant { does, caught_by, say, ..Variant::FAITHFUL }
}

pub const VARIANTS: &[Variant] = &[
    // Greeting.
    hears("stays in Boot", "Hello ends Boot", |_, request| match request {
        HostMessage::Hello(hello) => vec![Hello { protocol_version: 0, ..hello }.into()],
        other => vec![other],
    }),
    says("has no board", "the identity has every field filled in", |_, answers| {
        each(answers, |answer| {
            if let DriveMessage::Identity(it) = answer {
                it.board = lashloop_protocol::text::Text::EMPTY;
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
    // Transitions.
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
                        it.request = lashloop_protocol::message::EmergencyStop::LAYOUT.kind;
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
    // Parameters.
    says("has lost its watchdog", "the drive has the parameters that every bench sets", |_, answers| {
        describing(answers, |it| {
            if it.name.as_str() == "watchdog_us" {
                it.name = lashloop_protocol::text::Text::new("dog_us");
            }
        })
    }),
    says("has one name for all", "every parameter has a name of its own", |_, answers| {
        describing(answers, |it| it.name = lashloop_protocol::text::Text::new("gain"))
    }),
    says(
        "has ranges of another type",
        "default, smallest and largest value are of one type",
        |_, answers| describing(answers, |it| it.min = ParameterValue::U32(0)),
    ),
    says("has defaults out of range", "every default lies in its range", |_, answers| {
        describing(answers, |it| it.default = ParameterValue::F32(f32::MAX))
    }),
    says("has other defaults than it says", "after a reset every parameter has its default", |_, answers| {
        describing(answers, |it| it.default = it.min)
    }),
    says(
        "has wider ranges than it takes",
        "every parameter takes its smallest and its largest value and reads it back",
        |_, answers| {
            describing(answers, |it| {
                if let ParameterValue::F32(max) = &mut it.max {
                    *max *= 2.0;
                }
            })
        },
    ),
    Variant {
        hear: |_, request| match request {
            // Any other request with one answer of its own.
            HostMessage::SetParameter(set) => {
                vec![lashloop_protocol::message::GetParameter { index: set.index }.into()]
            }
            other => vec![other],
        },
        ..says(
            "reads back what it was told instead of what it has",
            "every parameter takes its smallest and its largest value and reads it back",
            |past, answers| reporting(past, answers, |it, set| it.value = set.value),
        )
    },
    says(
        "takes what is out of range",
        "a value out of range is refused and changes nothing",
        |past, answers| {
            reporting(past, answers, |it, set| {
                if it.outcome == Outcome::OutOfRange {
                    (it.outcome, it.value) = (Outcome::Accepted, set.value);
                }
            })
        },
    ),
    hears("converts types", "a value of the wrong type is refused and changes nothing", |_, request| {
        match request {
            HostMessage::SetParameter(SetParameter { index, value: ParameterValue::U32(value) })
                if index > 8 =>
            {
                vec![SetParameter { index, value: ParameterValue::F32(value as f32) }.into()]
            }
            other => vec![other],
        }
    }),
    says("knows every index", "an index that no parameter has is refused", |_, answers| {
        each(answers, |answer| match answer {
            DriveMessage::ParameterReport(it) if it.outcome == Outcome::UnknownParameter => {
                it.outcome = Outcome::Accepted;
            }
            _ => {}
        })
    }),
    says(
        "keeps a parameter through Reset",
        "a reset brings back the default of what was set",
        |past, answers| {
            if matches!(past.request, Some(HostMessage::Reset(_))) {
                past.number += 1;
            }
            // Wrong from the second value on that is read after a set of the torque limit.
            if let Some(HostMessage::SetParameter(SetParameter { index: 4, .. })) = past.request {
                past.kept = past.request;
            }
            let kept = past.kept;
            each(answers, |answer| match (answer, kept) {
                (DriveMessage::ParameterReport(it), Some(HostMessage::SetParameter(set)))
                    if it.index == 4 =>
                {
                    it.value = set.value;
                }
                _ => {}
            })
        },
    ),
    says(
        "has an identity of its own",
        "the identity has the period and the encoders that were set",
        |_, answers| {
            each(answers, |answer| {
                if let DriveMessage::Identity(it) = answer {
                    it.period_us = 1_000;
                }
            })
        },
    ),
    says(
        "takes everything while running",
        "while running a parameter is taken if it is live and refused if not",
        |past, answers| reporting(past, answers, |it, _| it.outcome = Outcome::Accepted),
    ),
    // Samples.
    says(
        "answers samples before the greeting",
        "a sample before the greeting is refused",
        |past, answers| {
            answering(past, answers, |sample, result| {
                (result.state == State::Boot).then_some(TorqueAnswer {
                    sequence: sample.sequence,
                    torque_nm: 0.0,
                    state: State::Boot,
                    flags: TorqueFlags::empty(),
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
                state: State::Running,
                flags: TorqueFlags::empty(),
                compute_tenths_us: 0,
            })
        })
    }),
    says(
        "does not flag repetitions",
        "a repeated sample gets the same torque, flagged REPEATED",
        |_, answers| torques(answers, |it| it.flags.remove(TorqueFlags::REPEATED)),
    ),
    says(
        "answers a repetition anew",
        "a repeated sample gets the same torque, flagged REPEATED",
        |_, answers| {
            torques(answers, |it| {
                if it.flags.contains(TorqueFlags::REPEATED) {
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
                if !it.flags.contains(TorqueFlags::REPEATED) {
                    it.torque_nm -= 0.001 * steps as f32;
                }
            })
        })
    },
    says("does not flag gaps", "a gap is flagged GAP, once", |_, answers| {
        torques(answers, |it| it.flags.remove(TorqueFlags::GAP))
    }),
    says(
        "answers stray samples",
        "a sample older than the last or far ahead of it is refused",
        |past, answers| {
            answering(past, answers, |sample, result| {
                (result.outcome == Outcome::OutOfSequence && sample.sequence > 1 << 30).then_some(
                    TorqueAnswer {
                        sequence: sample.sequence,
                        torque_nm: 1.0,
                        state: State::Running,
                        flags: TorqueFlags::GAP,
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
            if it.state == State::Idle {
                it.torque_nm = 1.0;
            }
        })
    }),
    says("pushes in Armed", "a sample gets torque zero in Armed", |_, answers| {
        torques(answers, |it| {
            if it.state == State::Armed {
                it.torque_nm = 1.0;
            }
        })
    }),
    // Safety.
    says("keeps its torque after a fault", "a sample gets torque zero in Faulted", |past, answers| {
        torques(answers, |it| {
            if it.state == State::Faulted {
                it.torque_nm = 1.0 + past.torque_nm;
            }
            past.torque_nm = it.torque_nm;
        })
    }),
    says(
        "gives more than its limit",
        "a torque beyond the limit is limited and flagged SATURATED",
        |_, answers| {
            torques(answers, |it| {
                if it.flags.contains(TorqueFlags::SATURATED) {
                    it.torque_nm *= 1.01;
                }
            })
        },
    ),
    says(
        "does not flag saturation",
        "a torque beyond the limit is limited and flagged SATURATED",
        |_, answers| torques(answers, |it| it.flags.remove(TorqueFlags::SATURATED)),
    ),
    says("tells of no fault", "EmergencyStop is answered with its fault", |_, mut answers| {
        answers.retain(|answer| !matches!(answer, DriveMessage::FaultReport(_)));
        answers
    }),
    says("tells the last fault", "the first fault is the one that is kept", |past, answers| {
        match past.request {
            Some(HostMessage::EmergencyStop(_)) => past.number = 1,
            Some(HostMessage::Reset(_)) => past.number = 0,
            _ => {}
        }
        let stopped = past.number == 1;
        each(answers, |answer| {
            if let (DriveMessage::FaultReport(it), true) = (answer, stopped) {
                it.code = FaultCode::EmergencyStop;
            }
        })
    }),
    hears("clears faults by Stop", "a fault stays latched through Stop and samples", |_, request| {
        match request {
            HostMessage::Stop(_) => vec![lashloop_protocol::message::ClearFault {}.into(), request],
            other => vec![other],
        }
    }),
    says("goes on where the fault was", "a fault that is cleared gives no torque back", |past, answers| {
        if matches!(past.request, Some(HostMessage::ClearFault(_))) {
            past.number = 1;
        } else if matches!(past.request, Some(HostMessage::Reset(_))) {
            past.number = 0;
        }
        let cleared = past.number == 1;
        torques(answers, |it| {
            if cleared {
                it.torque_nm = 1.0;
            }
        })
    }),
    Variant {
        does: "has no watchdog",
        caught_by: "without samples the watchdog trips, not before its time",
        timeless: true,
        ..Variant::FAITHFUL
    },
    hears("has a hasty watchdog", "without samples the watchdog trips, not before its time", |_, request| {
        match request {
            HostMessage::SetParameter(SetParameter { index: 5, value: ParameterValue::U32(value) })
                if value == 100_000 =>
            {
                vec![SetParameter { index: 5, value: ParameterValue::U32(value / 5) }.into()]
            }
            other => vec![other],
        }
    }),
    says(
        "keeps its torque when the watchdog trips",
        "after the watchdog has tripped there is no torque",
        |past, answers| {
            let tripped =
                |answer: &DriveMessage| matches!(answer, DriveMessage::FaultReport(it) if it.limit == 0.1);
            past.number = match past.request {
                Some(HostMessage::Reset(_)) => 0,
                _ if answers.iter().any(tripped) => 1,
                _ => past.number,
            };
            let tripped = past.number == 1;
            torques(answers, |it| {
                if tripped {
                    it.torque_nm = 1.0;
                }
            })
        },
    ),
    hears(
        "feeds its watchdog with repetitions",
        "repeating one sample does not feed the watchdog",
        |past, request| match request {
            HostMessage::EncoderSample(sample) => {
                past.number += u32::from(past.kept == Some(request));
                past.kept = Some(request);
                vec![EncoderSample { sequence: sample.sequence + past.number, ..sample }.into()]
            }
            HostMessage::Start(_) => {
                (past.kept, past.number) = (None, 0);
                vec![request]
            }
            other => vec![other],
        },
    ),
    hears(
        "believes any motor encoder",
        "a motor encoder that jumps is a fault",
        |_, request| match request {
            HostMessage::EncoderSample(sample) if sample.motor_counts.unsigned_abs() > 700 => {
                vec![EncoderSample { motor_counts: 0, ..sample }.into()]
            }
            other => vec![other],
        },
    ),
    hears("believes any load encoder", "a load encoder that jumps is a fault", |_, request| match request {
        HostMessage::EncoderSample(sample) if sample.load_counts.unsigned_abs() > 700 => {
            vec![EncoderSample { load_counts: 0, ..sample }.into()]
        }
        other => vec![other],
    }),
    hears(
        "believes no encoder",
        "an encoder within its speed limit is believed",
        |_, request| match request {
            HostMessage::EncoderSample(sample) if sample.motor_counts.unsigned_abs() > 300 => {
                vec![EncoderSample { motor_counts: 1 << 30, ..sample }.into()]
            }
            other => vec![other],
        },
    ),
    hears("does not know that counters wrap", "an encoder that wraps around has not jumped", |_, request| {
        match request {
            HostMessage::EncoderSample(sample) if sample.motor_counts == i32::MIN => {
                vec![EncoderSample { motor_counts: 0, ..sample }.into()]
            }
            other => vec![other],
        }
    }),
    hears("takes NaN for zero", "a reference that is not finite is a fault", |_, request| match request {
        HostMessage::EncoderSample(sample) if sample.reference_rad.is_nan() => {
            vec![EncoderSample { reference_rad: 0.0, ..sample }.into()]
        }
        other => vec![other],
    }),
    says("coasts down slowly", "Stop takes the torque away", |past, answers| {
        let stopped = matches!(past.request, Some(HostMessage::EncoderSample(_)));
        torques(answers, |it| {
            if stopped && it.state != State::Running && past.torque_nm != 0.0 {
                it.torque_nm = 0.5 * past.torque_nm;
            }
            past.torque_nm = it.torque_nm;
        })
    }),
    // The line.
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
    // The time of answers.
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

fn each(mut answers: Vec<DriveMessage>, alter: impl FnMut(&mut DriveMessage)) -> Vec<DriveMessage> {
    answers.iter_mut().for_each(alter);
    answers
}

fn torques(answers: Vec<DriveMessage>, mut alter: impl FnMut(&mut TorqueAnswer)) -> Vec<DriveMessage> {
    each(answers, |answer| {
        if let DriveMessage::TorqueAnswer(it) = answer {
            alter(it);
        }
    })
}

fn describing(
    answers: Vec<DriveMessage>,
    alter: impl Fn(&mut lashloop_protocol::message::ParameterDescription),
) -> Vec<DriveMessage> {
    each(answers, |answer| {
        if let DriveMessage::ParameterDescription(it) = answer {
            alter(it);
        }
    })
}

/// Alters the reports that answer a set.
fn reporting(
    past: &Past,
    answers: Vec<DriveMessage>,
    alter: impl Fn(&mut ParameterReport, SetParameter),
) -> Vec<DriveMessage> {
    each(answers, |answer| {
        if let (DriveMessage::ParameterReport(it), Some(HostMessage::SetParameter(set))) =
            (answer, past.request)
        {
            alter(it, set);
        }
    })
}

/// Puts a torque in place of the refusal of a sample.
fn answering(
    past: &Past,
    answers: Vec<DriveMessage>,
    torque: impl Fn(EncoderSample, CommandResult) -> Option<TorqueAnswer>,
) -> Vec<DriveMessage> {
    each(answers, |answer| {
        if let (DriveMessage::CommandResult(it), Some(HostMessage::EncoderSample(sample))) =
            (&*answer, past.request)
            && let Some(torque) = torque(sample, *it)
        {
            *answer = torque.into();
        }
    })
}

fn is_result_of<Request: Payload>(answer: &DriveMessage) -> bool {
    matches!(answer, DriveMessage::CommandResult(it) if it.request == Request::LAYOUT.kind)
}

fn telemetry(answer: TorqueAnswer) -> Telemetry {
    Telemetry {
        sequence: answer.sequence,
        dead_zone_estimate_rad: 0.0,
        disturbing_torque_nm: 0.0,
        load_error_rad: 0.0,
        motor_error_rad: 0.0,
        elastic_error_nm: 0.0,
        requested_torque_nm: answer.torque_nm,
    }
}
