//! Drives with wrong telemetry.

use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{Outcome, TorqueFlags};
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;
use lashloop_protocol::message::{Subscribe, Telemetry};
use lashloop_protocol::telemetry_values::TelemetryValues;
use lashloop_protocol::{DriveMessage, HostMessage};

use super::{alters_answers, each, is_result_of};
use crate::laws::TestLaws;
use crate::mutants::Variant;

/// Telemetry of one zero.
fn telemetry(sequence: u16) -> DriveMessage {
    Telemetry { sequence, values: TelemetryValues::new(&[0.0]).expect("one value") }.into()
}

/// Answers to `Subscribe` with another outcome in place of one.
fn subscribing(answers: Vec<DriveMessage>, from: Outcome, to: Outcome) -> Vec<DriveMessage> {
    each(answers, |answer| {
        let is_result = is_result_of::<Subscribe>(answer);
        if let DriveMessage::CommandResult(it) = answer
            && is_result
            && it.outcome == from
        {
            it.outcome = to;
        }
    })
}

/// Telemetry with other values.
fn values(answers: Vec<DriveMessage>, alter: fn(&mut [f32])) -> Vec<DriveMessage> {
    each(answers, |answer| {
        if let DriveMessage::Telemetry(it) = answer {
            let mut values = it.values.as_slice().to_vec();
            alter(&mut values);
            it.values = TelemetryValues::new(&values).expect("as many values");
        }
    })
}

/// Whether the drive refuses this subscription in `Idle`.
fn is_refused(request: &HostMessage) -> bool {
    let known = (1_u64 << TestLaws::SIGNALS.len()) - 1;
    let HostMessage::Subscribe(Subscribe { signals, .. }) = request else { return false };
    u64::from(*signals) & !known != 0 || signals.count_ones() as usize > MAX_TELEMETRY_VALUES
}

/// Ends the subscription with each one that it refuses.
const fn drops_on_refusal(caught_by: &'static str) -> Variant {
    Variant {
        does: "drops its subscription on a refusal",
        caught_by,
        on_request: |_, request| {
            let dropped = is_refused(&request).then(|| Subscribe { signals: 0, every: 0 }.into());
            [request].into_iter().chain(dropped).collect()
        },
        on_answers: |memory, mut answers| {
            if memory.request.as_ref().is_some_and(is_refused) {
                answers.truncate(1);
            }
            answers
        },
        ..Variant::UNCHANGED
    }
}

pub const VARIANTS: &[Variant] = &[
    alters_answers(
        "sends telemetry before the torque",
        "telemetry follows the torque of every n-th sample",
        |_, mut answers| {
            answers.sort_by_key(|answer| !matches!(answer, DriveMessage::Telemetry(_)));
            answers
        },
    ),
    alters_answers(
        "repeats telemetry with a torque",
        "no telemetry follows a repeated sample",
        |_, mut answers| {
            if let Some(DriveMessage::TorqueAnswer(it)) = answers.first().copied()
                && it.status.flags.contains(TorqueFlags::REPEATED)
            {
                answers.push(telemetry(it.sequence));
            }
            answers
        },
    ),
    alters_answers(
        "sends telemetry with every torque",
        "every = 0 and no signal mean no telemetry",
        |_, mut answers| {
            if let Some(DriveMessage::TorqueAnswer(it)) = answers.first().copied()
                && answers.len() == 1
            {
                answers.push(telemetry(it.sequence));
            }
            answers
        },
    ),
    Variant {
        does: "forgets the subscription in a new session",
        caught_by: "a subscription outlives sessions, stops and faults",
        on_request: |_, request| match request {
            HostMessage::Hello(_) => vec![request, Subscribe { signals: 0, every: 0 }.into()],
            other => vec![other],
        },
        on_answers: |memory, mut answers| {
            if matches!(memory.request, Some(HostMessage::Hello(_))) {
                answers.retain(|answer| !is_result_of::<Subscribe>(answer));
            }
            answers
        },
        ..Variant::UNCHANGED
    },
    alters_answers(
        "sends telemetry from the second sample after a subscription on",
        "a subscription while running takes effect from the next sample",
        |_, mut answers| {
            answers.retain(|answer| !matches!(answer, DriveMessage::Telemetry(it) if it.sequence == 1));
            answers
        },
    ),
    alters_answers(
        "sends the last signal first",
        "values are those of the subscribed signals, in the order of their indices",
        |_, answers| values(answers, <[f32]>::reverse),
    ),
    alters_answers(
        "accepts unknown signals",
        "a signal that the drive does not have is refused and changes nothing",
        |_, answers| subscribing(answers, Outcome::UnknownIndex, Outcome::Accepted),
    ),
    alters_answers(
        "accepts any number of signals",
        "more than 13 signals are refused as OutOfRange and change nothing",
        |_, answers| subscribing(answers, Outcome::OutOfRange, Outcome::Accepted),
    ),
    drops_on_refusal("a signal that the drive does not have is refused and changes nothing"),
    drops_on_refusal("more than 13 signals are refused as OutOfRange and change nothing"),
    alters_answers(
        "accepts signals of another law",
        "a signal that the law in force lacks is refused by Arm, and when armed",
        |_, answers| subscribing(answers, Outcome::Inconsistent, Outcome::Accepted),
    ),
    alters_answers(
        "refuses signals of another law without a log",
        "a signal that the law in force lacks is refused by Arm, and when armed",
        |_, mut answers| {
            answers.retain(|answer| !matches!(answer, DriveMessage::Log(_)));
            answers
        },
    ),
    alters_answers(
        "names a signal after the refusal",
        "a signal that the law in force lacks is refused by Arm, and when armed",
        |_, mut answers| {
            answers.sort_by_key(|answer| matches!(answer, DriveMessage::Log(_)));
            answers
        },
    ),
    alters_answers(
        "reports the limited torque",
        "telemetry carries the requested torque before the limit",
        |_, answers| values(answers, |values| values.fill(0.0)),
    ),
    alters_answers("is subscribed to in Boot", "Subscribe is refused in Boot", |_, answers| {
        subscribing(answers, Outcome::WrongState, Outcome::Accepted)
    }),
    alters_answers("is never subscribed to", "Subscribe is accepted in Running", |_, answers| {
        subscribing(answers, Outcome::Accepted, Outcome::WrongState)
    }),
];
