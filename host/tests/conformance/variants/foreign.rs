//! Drives that are right, with other defaults and ranges than the Lashloop drive.

use lashloop_protocol::message::SetParameter;
use lashloop_protocol::vocabulary::ParameterValue;
use lashloop_protocol::{DriveMessage, HostMessage, PROTOCOL_VERSION};

use super::describing;
use crate::altered::Variant;

const COUNTS_PER_REV: ParameterValue = ParameterValue::U32(1 << 20);
/// `motor_counts_per_rev` and `load_counts_per_rev`.
const ENCODERS: [u8; 2] = [2, 3];

/// The first greeting after a reset sets what is then said to be the default; the second one tells of it.
pub const FINE: Variant = Variant {
    does: "has fine encoders",
    hear: |past, request| match request {
        HostMessage::Hello(hello) if past.number == 0 && hello.protocol_version == PROTOCOL_VERSION => {
            past.number = 1;
            let set = ENCODERS.map(|index| SetParameter { index, value: COUNTS_PER_REV }.into());
            [&[request], &set[..], &[request]].concat()
        }
        HostMessage::Reset(_) => {
            past.number = 0;
            vec![request]
        }
        other => vec![other],
    },
    say: |past, mut answers| {
        if matches!(past.request, Some(HostMessage::Hello(_)))
            && let Some(set) = answers.iter().rposition(|it| matches!(it, DriveMessage::ParameterReport(_)))
        {
            answers.drain(..=set);
        }
        describing(answers, |it| {
            if ENCODERS.contains(&it.index) {
                it.default = COUNTS_PER_REV;
            }
        })
    },
    ..Variant::FAITHFUL
};

/// Says that it takes no load faster than this.
pub const SLOW: Variant = Variant {
    does: "has a slow load",
    say: |_, answers| {
        describing(answers, |it| {
            if it.name.as_str() == "load_speed_limit_rad_s" {
                it.max = ParameterValue::F32(200.0);
            }
        })
    },
    ..Variant::FAITHFUL
};
