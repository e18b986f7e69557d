//! Mutants of faults, limits and the watchdog.

use lashloop_protocol::enums::{FaultCode, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{ClearFault, EncoderSample, SetParameter};
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{alters_answers, alters_requests, each, torques};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    alters_answers(
        "keeps its torque after a fault",
        "a sample gets torque zero in Faulted",
        |memory, answers| {
            torques(answers, |it| {
                if it.status.state == State::Faulted {
                    it.torque_nm = 1.0 + memory.torque_nm;
                }
                memory.torque_nm = it.torque_nm;
            })
        },
    ),
    alters_answers(
        "gives more than its limit",
        "a torque beyond the limit is limited and flagged SATURATED",
        |_, answers| {
            torques(answers, |it| {
                if it.status.flags.contains(TorqueFlags::SATURATED) {
                    it.torque_nm *= 1.01;
                }
            })
        },
    ),
    alters_answers(
        "does not flag saturation",
        "a torque beyond the limit is limited and flagged SATURATED",
        |_, answers| torques(answers, |it| it.status.flags.remove(TorqueFlags::SATURATED)),
    ),
    alters_answers("reports no fault", "EmergencyStop is answered with its fault", |_, mut answers| {
        answers.retain(|answer| !matches!(answer, DriveMessage::FaultReport(_)));
        answers
    }),
    alters_answers("reports the last fault", "the first fault stays latched", |memory, answers| {
        match memory.request {
            Some(HostMessage::EmergencyStop(_)) => memory.number = 1,
            Some(HostMessage::Reset(_)) => memory.number = 0,
            _ => {}
        }
        let stopped = memory.number == 1;
        each(answers, |answer| {
            if let (DriveMessage::FaultReport(it), true) = (answer, stopped) {
                it.code = FaultCode::EmergencyStop;
            }
        })
    }),
    alters_requests(
        "clears faults by Stop",
        "a fault stays latched through Stop and samples",
        |_, request| match request {
            HostMessage::Stop(_) => vec![ClearFault {}.into(), request],
            other => vec![other],
        },
    ),
    alters_answers("goes on where the fault was", "a cleared fault restores no torque", |memory, answers| {
        if matches!(memory.request, Some(HostMessage::ClearFault(_))) {
            memory.number = 1;
        } else if matches!(memory.request, Some(HostMessage::Reset(_))) {
            memory.number = 0;
        }
        let cleared = memory.number == 1;
        torques(answers, |it| {
            if cleared {
                it.torque_nm = 1.0;
            }
        })
    }),
    Variant {
        does: "has no watchdog",
        caught_by: "without samples the watchdog trips, and not early",
        clock_stands: true,
        ..Variant::UNCHANGED
    },
    alters_requests(
        "has a hasty watchdog",
        "without samples the watchdog trips, and not early",
        |_, request| match request {
            HostMessage::SetParameter(SetParameter { index: 6, value: ParameterValue::U32(value) })
                if value == 100_000 =>
            {
                vec![SetParameter { index: 6, value: ParameterValue::U32(value / 5) }.into()]
            }
            other => vec![other],
        },
    ),
    alters_answers(
        "keeps its torque when the watchdog trips",
        "after the watchdog has tripped there is no torque",
        |memory, answers| {
            let tripped =
                |answer: &DriveMessage| matches!(answer, DriveMessage::FaultReport(it) if it.limit == 0.1);
            memory.number = match memory.request {
                Some(HostMessage::Reset(_)) => 0,
                _ if answers.iter().any(tripped) => 1,
                _ => memory.number,
            };
            let tripped = memory.number == 1;
            torques(answers, |it| {
                if tripped {
                    it.torque_nm = 1.0;
                }
            })
        },
    ),
    alters_requests(
        "feeds its watchdog with repetitions",
        "repeating one sample does not feed the watchdog",
        |memory, request| match request {
            HostMessage::EncoderSample(sample) => {
                memory.number += u32::from(memory.kept == Some(request));
                memory.kept = Some(request);
                vec![EncoderSample { sequence: sample.sequence + memory.number as u16, ..sample }.into()]
            }
            HostMessage::Start(_) => {
                (memory.kept, memory.number) = (None, 0);
                vec![request]
            }
            other => vec![other],
        },
    ),
    alters_requests("takes NaN for zero", "a reference that is not finite is a fault", |_, request| {
        match request {
            HostMessage::EncoderSample(sample) if sample.reference_rad.is_nan() => {
                vec![EncoderSample { reference_rad: 0.0, ..sample }.into()]
            }
            other => vec![other],
        }
    }),
    alters_answers("coasts down slowly", "Stop takes the torque away", |memory, answers| {
        let stopped = matches!(memory.request, Some(HostMessage::EncoderSample(_)));
        torques(answers, |it| {
            if stopped && it.status.state != State::Running && memory.torque_nm != 0.0 {
                it.torque_nm = 0.5 * memory.torque_nm;
            }
            memory.torque_nm = it.torque_nm;
        })
    }),
];
