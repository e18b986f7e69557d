//! The table of answers: which messages, in which order.

use std::time::Duration;

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{ParameterValue, State};
use lashloop_protocol::message::{DescribeParameter, EncoderSample, SetParameter};

use crate::markdown::{section, table};
use crate::talk::{SESSION, Talk, names, request, rest};

fn running_after(samples: u16) -> Talk {
    let mut talk = Talk::running(&[]);
    for sequence in 0..samples {
        talk.sample(sequence);
    }
    talk
}

/// What the drive says in the case that the document describes, each time it can be brought about.
fn answers(message: &str, case: &str) -> Vec<Vec<DriveMessage>> {
    let everywhere = || State::ALL.iter().map(|state| Talk::in_state(*state).say(request(message))).collect();
    match (message, case) {
        ("Hello", "same version") => vec![Talk::in_state(State::Boot).say(request("Hello, same session"))],
        ("Hello", "same version, fault latched") => {
            vec![Talk::in_state(State::Faulted).say(request("Hello, same session"))]
        }
        ("Hello", "another version") => {
            vec![Talk::in_state(State::Idle).say(request("Hello, another version"))]
        }
        ("Hello", "another version, fault latched") => {
            vec![Talk::in_state(State::Faulted).say(request("Hello, another version"))]
        }
        ("DescribeParameter", "unknown index") => {
            vec![Talk::in_state(State::Idle).say(DescribeParameter { index: 255 })]
        }
        ("Arm", "parameters don't go together") => {
            let mut talk = Talk::in_state(State::Idle);
            for (name, value) in
                [("controller", ParameterValue::U32(2)), ("dead_zone_max_rad", ParameterValue::F32(0.1))]
            {
                talk.say(SetParameter { index: crate::talk::index(name), value });
            }
            vec![talk.say(lashloop_protocol::message::Arm { session: SESSION })]
        }
        ("Arm", "done, wrong state, wrong session")
        | ("DescribeParameter", "known index")
        | ("GetParameter" | "SetParameter", "any index")
        | ("Start" | "Stop" | "EmergencyStop" | "ClearFault" | "Reset", "any") => everywhere(),
        ("EncoderSample", "Boot") => vec![Talk::in_state(State::Boot).sample(0)],
        ("EncoderSample", "Idle, Armed, Faulted") => {
            [State::Idle, State::Armed, State::Faulted].map(|state| Talk::in_state(state).sample(9)).into()
        }
        ("EncoderSample", "Running, no telemetry due") => vec![running_after(1).sample(1)],
        ("EncoderSample", "Running, telemetry due") => {
            vec![running_after(0).sample(0), running_after(10).sample(10)]
        }
        ("EncoderSample", "Running, the sample causes a fault") => {
            vec![running_after(10).say(EncoderSample { reference_rad: f32::NAN, ..rest(10) })]
        }
        ("EncoderSample", "Running, later than the watchdog allows") => {
            let mut talk = running_after(1);
            talk.wait(Duration::from_secs(1));
            vec![talk.sample(1)]
        }
        ("EncoderSample", "Running, repeated") => vec![running_after(1).sample(0)],
        ("EncoderSample", "Running, out of sequence") => vec![running_after(2).sample(0)],
        other => panic!("the document has a case {other:?} that this test can't bring about"),
    }
}

#[test]
fn every_request_is_answered_by_these_messages_in_this_order() {
    for row in table(section("### Answers"), "request") {
        for have in answers(&row[0], &row[1]) {
            assert_eq!(names(&have), row[2], "{}: {}", row[0], row[1]);
        }
    }
}
