//! Wrong about faults, limits and the watchdog.

use lashloop_protocol::enums::{FaultCode, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{ClearFault, EncoderSample, SetParameter};
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{each, hears, says, torques};
use crate::mutants::Variant;

pub const VARIANTS: &[Variant] = &[
    says("keeps its torque after a fault", "a sample gets torque zero in Faulted", |past, answers| {
        torques(answers, |it| {
            if it.status.state == State::Faulted {
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
                if it.status.flags.contains(TorqueFlags::SATURATED) {
                    it.torque_nm *= 1.01;
                }
            })
        },
    ),
    says(
        "does not flag saturation",
        "a torque beyond the limit is limited and flagged SATURATED",
        |_, answers| torques(answers, |it| it.status.flags.remove(TorqueFlags::SATURATED)),
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
            HostMessage::Stop(_) => vec![ClearFault {}.into(), request],
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
        ..Variant::MERZOUKI
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
                vec![EncoderSample { sequence: sample.sequence + past.number as u16, ..sample }.into()]
            }
            HostMessage::Start(_) => {
                (past.kept, past.number) = (None, 0);
                vec![request]
            }
            other => vec![other],
        },
    ),
    hears("takes NaN for zero", "a reference that is not finite is a fault", |_, request| match request {
        HostMessage::EncoderSample(sample) if sample.reference_rad.is_nan() => {
            vec![EncoderSample { reference_rad: 0.0, ..sample }.into()]
        }
        other => vec![other],
    }),
    says("coasts down slowly", "Stop takes the torque away", |past, answers| {
        let stopped = matches!(past.request, Some(HostMessage::EncoderSample(_)));
        torques(answers, |it| {
            if stopped && it.status.state != State::Running && past.torque_nm != 0.0 {
                it.torque_nm = 0.5 * past.torque_nm;
            }
            past.torque_nm = it.torque_nm;
        })
    }),
];
