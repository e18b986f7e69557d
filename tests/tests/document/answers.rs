//! The table of answers: which messages, in which order.

use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{ParameterValue, State};
use lashloop_protocol::message::{
    DescribeChoice, DescribeLaw, DescribeParameter, DescribeSignal, EncoderSample, SetParameter, Subscribe,
};
use lashloop_protocol::parameter_names::CONTROLLER;

use crate::host::{Host, index, names, refusal, request, rest};
use crate::markdown::{section, table};
use crate::two_laws::{OF_THE_SECOND_LAW, TwoLaws};

/// A running drive whose telemetry follows every 10th torque.
fn running_after(samples: u16) -> Host {
    let mut host = Host::running(&[]);
    host.send(request("Subscribe"));
    for sequence in 0..samples {
        host.sample(sequence);
    }
    host
}

/// Parameter and choice of each documented case.
fn unknown_choices() -> [(u8, u8); 3] {
    [(255, 0), (index("k_p1"), 0), (index(CONTROLLER), Laws::NAMES.len() as u8)]
}

/// The drive's answers in a case of the document, one list for each way to reach the case.
fn answers(message: &str, case: &str) -> Vec<Vec<DriveMessage>> {
    let everywhere =
        || State::ALL.iter().map(|state| Host::in_state(*state).send(request(message))).collect();
    match (message, case) {
        ("Hello", "same version") => vec![Host::in_state(State::Boot).send(request("Hello, same session"))],
        ("Hello", "same version, fault latched") => {
            vec![Host::in_state(State::Faulted).send(request("Hello, same session"))]
        }
        ("Hello", "another version") => {
            vec![Host::in_state(State::Idle).send(request("Hello, another version"))]
        }
        ("Hello", "another version, fault latched") => {
            vec![Host::in_state(State::Faulted).send(request("Hello, another version"))]
        }
        ("DescribeParameter", "unknown index") => {
            vec![Host::in_state(State::Idle).send(DescribeParameter { index: 255 })]
        }
        ("Arm", "parameters don't go together") => {
            let mut host = Host::in_state(State::Idle);
            for (name, value) in
                [("controller", ParameterValue::U32(1)), ("dead_zone_max_rad", ParameterValue::F32(0.1))]
            {
                host.send(SetParameter { index: index(name), value });
            }
            vec![host.send(request("Arm"))]
        }
        ("DescribeLaw", "unknown index") => {
            vec![Host::in_state(State::Idle).send(DescribeLaw { index: Laws::NAMES.len() as u8 })]
        }
        ("DescribeSignal", "unknown index") => {
            vec![Host::in_state(State::Idle).send(DescribeSignal { index: Laws::SIGNALS.len() as u8 })]
        }
        ("DescribeChoice", "unknown index") => unknown_choices()
            .map(|(parameter, choice)| Host::in_state(State::Idle).send(DescribeChoice { parameter, choice }))
            .into(),
        ("Subscribe", "done, refused for any other reason") => {
            let too_many = Subscribe { signals: u32::MAX, every: 1 };
            State::ALL
                .iter()
                .flat_map(|state| {
                    [request(message), too_many.into()].map(|it| Host::in_state(*state).send(it))
                })
                .collect()
        }
        ("Subscribe", "the law in force lacks a signal") => {
            let subscribe = |state| Host::<TwoLaws>::with_laws_in_state(state).send(OF_THE_SECOND_LAW);
            [State::Armed, State::Running].map(subscribe).into()
        }
        ("Arm", "the law in force lacks a subscribed signal") => {
            let mut host = Host::<TwoLaws>::with_laws_in_state(State::Idle);
            assert_eq!(refusal(&host.send(OF_THE_SECOND_LAW)), None);
            vec![host.send(request("Arm"))]
        }
        ("Arm", "done, wrong state, wrong session")
        | ("DescribeParameter" | "DescribeLaw" | "DescribeSignal" | "DescribeChoice", "known index")
        | ("GetParameter" | "SetParameter", "any index")
        | ("Start" | "Stop" | "EmergencyStop" | "ClearFault" | "Reset", "any") => everywhere(),
        ("EncoderSample", "Boot") => vec![Host::in_state(State::Boot).sample(0)],
        ("EncoderSample", "Idle, Armed, Faulted") => {
            [State::Idle, State::Armed, State::Faulted].map(|state| Host::in_state(state).sample(9)).into()
        }
        ("EncoderSample", "Running, no telemetry due") => vec![running_after(1).sample(1)],
        ("EncoderSample", "Running, telemetry due") => {
            vec![running_after(0).sample(0), running_after(10).sample(10)]
        }
        ("EncoderSample", "Running, the sample causes a fault") => {
            vec![running_after(10).send(EncoderSample { reference_rad: f32::NAN, ..rest(10) })]
        }
        ("EncoderSample", "Running, later than the watchdog allows") => {
            let mut host = running_after(1);
            host.wait(Duration::from_secs(1));
            vec![host.sample(1)]
        }
        ("EncoderSample", "Running, repeated") => vec![running_after(1).sample(0)],
        ("EncoderSample", "Running, out of sequence") => vec![running_after(2).sample(0)],
        other => panic!("this test can't reach the case {other:?} of the document"),
    }
}

#[test]
fn every_request_gets_the_documented_answers_in_order() {
    for row in table(section("### Answers"), "request") {
        for have in answers(&row[0], &row[1]) {
            assert_eq!(names(&have), row[2], "{}: {}", row[0], row[1]);
        }
    }
}
