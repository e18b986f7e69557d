//! The table of answers: which messages, in which order.

use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::layout::has_number;
use lashloop_protocol::limits::{FAULT_NAMES, FLAG_NAMES, KIND_NAMES, OUTCOME_NAMES, STATE_NAMES};
use lashloop_protocol::message::{
    DescribeChoice, DescribeLaw, DescribeParameter, DescribeSignal, EncoderSample, SetParameter, Subscribe,
};
use lashloop_protocol::parameter_names::CONTROLLER;
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use crate::alterations::frame_around;
use crate::host::{Host, index, names, refusal, refusal_with_detail, request, rest};
use crate::markdown::{section, table};
use crate::two_laws::{OF_THE_SECOND_LAW, TwoLaws};

/// A value below that of `dead_zone_initial_rad`.
const DEAD_ZONE_BELOW_ITS_START: (&str, ParameterValue) = ("dead_zone_max_rad", ParameterValue::F32(0.1));

/// A running drive whose telemetry follows every 10th torque.
fn running_after(samples: u16) -> Host {
    let mut host = Host::running(&[]);
    host.send(request("Subscribe"));
    for sequence in 0..samples {
        host.sample(sequence);
    }
    host
}

/// Parameter and choice of each documented case: of no parameter, without choices, beyond the choices, of no value of a list.
fn unknown_choices() -> [(u8, u8); 5] {
    let beyond = Laws::NAMES.len() as u8;
    [(240, 0), (index("k_p1"), 0), (index(CONTROLLER), beyond), (FAULT_NAMES, 0), (FAULT_NAMES, 77)]
}

/// An idle drive whose parameters contradict each other.
fn contradicting() -> Host {
    let mut host = Host::in_state(State::Idle);
    for (name, value) in [(CONTROLLER, ParameterValue::U32(1)), DEAD_ZONE_BELOW_ITS_START] {
        assert_eq!(refusal(&host.send(SetParameter { index: index(name), value })), None);
    }
    host
}

/// The drive's answers in a case of the document, one list for each way to reach the case.
fn answers(message: &str, case: &str) -> Vec<Vec<DriveMessage>> {
    let everywhere = || -> Vec<_> {
        State::ALL.iter().map(|state| Host::in_state(*state).send(request(message))).collect()
    };
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
        ("DescribeLaw", "unknown index") => {
            vec![Host::in_state(State::Idle).send(DescribeLaw { index: Laws::NAMES.len() as u8 })]
        }
        ("DescribeSignal", "unknown index") => {
            vec![Host::in_state(State::Idle).send(DescribeSignal { index: Laws::SIGNALS.len() as u8 })]
        }
        ("DescribeChoice", "unknown index") => unknown_choices()
            .map(|(parameter, choice)| Host::in_state(State::Idle).send(DescribeChoice { parameter, choice }))
            .into(),
        ("Subscribe", "any") => {
            let too_many = Subscribe { signals: u32::MAX, every: 1 };
            let lacking = |state| Host::<TwoLaws>::with_laws_in_state(state).send(OF_THE_SECOND_LAW);
            let refused = State::ALL.iter().map(|state| Host::in_state(*state).send(too_many));
            everywhere()
                .into_iter()
                .chain(refused)
                .chain([State::Armed, State::Running].map(lacking))
                .collect()
        }
        ("Arm", "any") => {
            let mut lacking = Host::<TwoLaws>::with_laws_in_state(State::Idle);
            assert_eq!(refusal(&lacking.send(OF_THE_SECOND_LAW)), None);
            let refused = [lacking.send(request("Arm")), contradicting().send(request("Arm"))];
            everywhere().into_iter().chain(refused).collect()
        }
        ("DescribeParameter" | "DescribeLaw" | "DescribeSignal" | "DescribeChoice", "known index")
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

#[test]
fn a_refusal_says_in_its_detail_what_it_is_about() {
    let (outcome, detail) = refusal_with_detail(&contradicting().send(request("Arm"))).expect("a refusal");
    assert_eq!(outcome, Outcome::Inconsistent);
    let pair = ["dead_zone_initial_rad", DEAD_ZONE_BELOW_ITS_START.0].map(|name| u32::from(index(name)));
    assert!(pair.contains(&detail), "parameter {detail} doesn't go with the others");
    let mut host = Host::<TwoLaws>::with_laws_in_state(State::Running);
    let signal = OF_THE_SECOND_LAW.signals.trailing_zeros();
    assert_eq!(refusal_with_detail(&host.send(OF_THE_SECOND_LAW)), Some((Outcome::SignalOfOtherLaw, signal)));
    // Every other outcome is about the request as a whole.
    assert_eq!(refusal_with_detail(&host.send(request("Arm"))), Some((Outcome::WrongState, 0)));
}

#[test]
fn an_unknown_request_is_refused_by_its_kind_and_number() {
    let requests: [(&[u8], u8); 3] = [(&[0x42, 9, 1, 2], 9), (&[0x7f], 0), (&[0x20, 255], 255)];
    for state in State::ALL {
        for (body, number) in requests {
            let mut host = Host::in_state(*state);
            let answers = host.exchange(&frame_around(body), number);
            let [DriveMessage::CommandResult(result)] = answers[..] else { panic!("{answers:?}") };
            assert_eq!((result.request, result.outcome), (body[0], Outcome::UnknownRequest));
            assert_eq!((result.state, host.drive.state()), (*state, *state));
        }
        for kind in 0x12..=0x1f {
            assert!(!has_number(kind));
            assert_eq!(Host::in_state(*state).exchange(&frame_around(&[kind, 9]), 0), []);
        }
    }
}

/// Number, values and names of the drive's lists.
fn lists() -> [(u8, Vec<(u8, &'static str)>); 5] {
    let kinds = HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS);
    [
        (FAULT_NAMES, FaultCode::LIST.values.to_vec()),
        (OUTCOME_NAMES, Outcome::LIST.values.to_vec()),
        (STATE_NAMES, State::LIST.values.to_vec()),
        (FLAG_NAMES, TorqueFlags::SET.flags.to_vec()),
        (KIND_NAMES, kinds.map(|layout| (layout.kind, layout.name)).collect()),
    ]
}

#[test]
fn the_drive_names_the_values_of_the_page() {
    let mut host = Host::in_state(State::Boot);
    for (parameter, values) in lists() {
        for (choice, name) in values {
            let answers = host.send(DescribeChoice { parameter, choice });
            let [DriveMessage::ChoiceDescription(it)] = answers[..] else { panic!("{name}: {answers:?}") };
            assert_eq!((it.parameter, it.choice, it.name.as_str()), (parameter, choice, name));
        }
    }
}
