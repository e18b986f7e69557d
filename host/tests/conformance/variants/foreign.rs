//! Drives with other defaults and ranges than the Lashloop drive: all are right but one.

use lashloop_protocol::enums::{ParameterValue, TorqueFlags};
use lashloop_protocol::message::{EncoderSample, SetParameter};
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage, PROTOCOL_VERSION};

use super::encoders::is_fast;
use super::{describing, torques};
use crate::mutants::{Memory, Variant};

const PERIOD: u8 = 1;
/// `motor_counts_per_rev` and `load_counts_per_rev`.
const ENCODERS: [u8; 2] = [2, 3];
const FINE_COUNTS: ParameterValue = ParameterValue::U32(1 << 20);

/// What the drive was built with: period and encoders, by index.
const BUILT_WITH: [(u8, u32); 3] = [(PERIOD, 500), (ENCODERS[0], 131_072), (ENCODERS[1], 131_072)];

pub const FINE: Variant = Variant {
    does: "has fine encoders",
    on_request: |memory, request| {
        let default = |index| SetParameter { index, value: FINE_COUNTS };
        defaulting(memory, request, &ENCODERS.map(default))
    },
    on_answers: |memory, answers| {
        describing(unsolicited_skipped(memory, answers), |it| {
            if ENCODERS.contains(&it.index) {
                it.default = FINE_COUNTS;
            }
        })
    },
    ..Variant::UNCHANGED
};

/// Takes the one value only, as a drive with one timer and absolute encoders does.
pub const FIXED: Variant = Variant {
    does: "has one period and one resolution",
    on_request: |memory, request| {
        let default = |(index, value)| SetParameter { index, value: ParameterValue::U32(value) };
        let request = match request {
            HostMessage::SetParameter(SetParameter { index, value: ParameterValue::U32(value) })
                if BUILT_WITH.iter().any(|&(fixed, only)| fixed == index && only != value) =>
            {
                // Out of the range of the drive itself, which then refuses it.
                SetParameter { index, value: ParameterValue::U32(0) }.into()
            }
            other => other,
        };
        defaulting(memory, request, &BUILT_WITH.map(default))
    },
    on_answers: |memory, answers| {
        describing(unsolicited_skipped(memory, answers), |it| {
            if let Some((_, only)) = BUILT_WITH.iter().find(|(index, _)| *index == it.index) {
                [it.default, it.min, it.max] = [ParameterValue::U32(*only); 3];
            }
        })
    },
    ..Variant::UNCHANGED
};

/// The same, but accepts any reading and reports no gaps.
pub const FIXED_CREDULOUS: Variant = Variant {
    does: "has one period and one resolution and accepts any reading",
    on_request: |memory, request| {
        let believable = |counts: EncoderCounts| {
            if is_fast(counts) { EncoderCounts::default() } else { counts }
        };
        let request = match request {
            HostMessage::EncoderSample(sample) => EncoderSample {
                motor_counts: believable(sample.motor_counts),
                load_counts: believable(sample.load_counts),
                ..sample
            }
            .into(),
            other => other,
        };
        (FIXED.on_request)(memory, request)
    },
    on_answers: |memory, answers| {
        torques((FIXED.on_answers)(memory, answers), |it| it.status.flags.remove(TorqueFlags::GAP))
    },
    ..Variant::UNCHANGED
};

/// The first handshake after a reset sets the values that the second one reports as defaults.
fn defaulting(memory: &mut Memory, request: HostMessage, defaults: &[SetParameter]) -> Vec<HostMessage> {
    match request {
        HostMessage::Hello(hello) if memory.number == 0 && hello.protocol_version == PROTOCOL_VERSION => {
            memory.number = 1;
            let set: Vec<_> = defaults.iter().map(|&it| it.into()).collect();
            [&[request], &set[..], &[request]].concat()
        }
        HostMessage::Reset(_) => {
            memory.number = 0;
            vec![request]
        }
        other => vec![other],
    }
}

/// The answers without those to what [`defaulting`] has put in.
fn unsolicited_skipped(memory: &Memory, mut answers: Vec<DriveMessage>) -> Vec<DriveMessage> {
    if matches!(memory.request, Some(HostMessage::Hello(_)))
        && let Some(set) = answers.iter().rposition(|it| matches!(it, DriveMessage::ParameterReport(_)))
    {
        answers.drain(..=set);
    }
    answers
}

/// Limits the range of the load's speed limit to this.
pub const SLOW: Variant = Variant {
    does: "has a slow load",
    on_answers: |_, answers| {
        describing(answers, |it| {
            if it.name.as_str() == "load_speed_limit_rad_s" {
                it.max = ParameterValue::F32(200.0);
            }
        })
    },
    ..Variant::UNCHANGED
};
