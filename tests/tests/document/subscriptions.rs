//! The rules of telemetry: what a subscription may hold, what keeps it, and when telemetry follows.

use lashloop_firmware::law::LawSet;
use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{SetParameter, Subscribe, Telemetry};

use crate::host::{Host, refusal, refusal_with_detail, request};
use crate::markdown::{section, table};
use crate::two_laws::{FIRST_OF_SECOND_LAW, OF_THE_SECOND_LAW, TwoLaws};

const SECOND_LAW: SetParameter = SetParameter { index: 0, value: ParameterValue::U32(1) };

fn host_in(state: State) -> Host<TwoLaws> {
    Host::with_laws_in_state(state)
}

/// Signals of each request that the document calls this case, while the first law is in force.
fn requests(case: &str) -> Vec<u32> {
    let count = TwoLaws::SIGNALS.len();
    let of_the_drive = (1 << FIRST_OF_SECOND_LAW) - 1;
    match case {
        "any" => vec![0, of_the_drive, u32::MAX],
        "a bit without a signal" => vec![1 << count, 1 << 31, u32::MAX],
        "more than 13 signals" => vec![(1 << 14) - 1, (1 << count) - 1],
        "a signal that the law in force lacks" => {
            vec![1 << FIRST_OF_SECOND_LAW, 0b11 << (count - 2), (1 << 13) - 1]
        }
        "any other" => vec![0, 1, of_the_drive],
        other => panic!("this test has no subscription for {other:?} of the document"),
    }
}

#[test]
fn every_subscription_gets_the_documented_outcome() {
    let mut states_seen = 0;
    for row in table(section("## 11. Telemetry"), "case") {
        let states =
            State::ALL.iter().filter(|state| row[1].split(", ").any(|name| name == state.to_string()));
        for state in states {
            states_seen += 1;
            for (signals, every) in
                requests(&row[0]).into_iter().flat_map(|signals| [(signals, 0), (signals, 1)])
            {
                let outcome = refusal(&host_in(*state).send(Subscribe { signals, every }));
                let have = outcome.unwrap_or(Outcome::Accepted).to_string();
                assert_eq!(have, row[2], "{}: signals {signals:#x} in {state}", row[0]);
            }
        }
    }
    assert_eq!(states_seen, 2 + 3 + 3 + 2 + 1 + 3, "every case of the table in every state of its row");
}

/// The telemetry among the answers to samples from 0, each with its sequence.
fn telemetry_of<L: LawSet>(host: &mut Host<L>, samples: u16) -> Vec<Telemetry> {
    let answers = (0..samples).flat_map(|sequence| host.sample(sequence));
    let telemetry = answers.filter_map(|answer| match answer {
        DriveMessage::Telemetry(telemetry) => Some(telemetry),
        _ => None,
    });
    telemetry.collect()
}

#[test]
fn telemetry_follows_every_multiple_of_the_sequence() {
    let mut host = host_in(State::Running);
    assert_eq!(telemetry_of(&mut host, 9), [], "no subscription after power-up");
    for (every, want) in [(1, (0..9).collect()), (4, vec![0, 4, 8]), (0, vec![])] {
        let mut host = host_in(State::Running);
        host.send(Subscribe { signals: 1, every });
        let sequences: Vec<u16> =
            telemetry_of(&mut host, 9).iter().map(|telemetry| telemetry.sequence).collect();
        assert_eq!(sequences, want, "every {every}");
    }
    let mut host = host_in(State::Running);
    host.send(Subscribe { signals: 0, every: 1 });
    assert_eq!(telemetry_of(&mut host, 9), [], "no signal");
}

#[test]
fn values_are_in_ascending_order_of_the_indices() {
    let mut host = host_in(State::Idle);
    host.send(SECOND_LAW);
    let signals = [0, 4, 12].map(|at| 1_u32 << (FIRST_OF_SECOND_LAW + at)).iter().sum();
    host.send(Subscribe { signals, every: 1 });
    host.send(request("Arm"));
    host.send(request("Start"));
    assert_eq!(telemetry_of(&mut host, 1)[0].values.as_slice(), [0.0, 4.0, 12.0]);
}

#[test]
fn a_subscription_is_checked_again_by_arm() {
    let mut host = host_in(State::Idle);
    host.send(OF_THE_SECOND_LAW);
    let refused = refusal_with_detail(&host.send(request("Arm")));
    assert_eq!(refused, Some((Outcome::SignalOfOtherLaw, FIRST_OF_SECOND_LAW as u32)));
    assert_eq!(host.drive.state(), State::Idle);
    host.send(SECOND_LAW);
    assert_eq!(refusal(&host.send(request("Arm"))), None);
}

#[test]
fn arm_accepts_a_subscription_without_a_rate() {
    let mut host = host_in(State::Idle);
    host.send(Subscribe { every: 0, ..OF_THE_SECOND_LAW });
    assert_eq!(refusal(&host.send(request("Arm"))), None);
    let answers = host.send(Subscribe { every: 0, ..OF_THE_SECOND_LAW });
    assert_eq!(refusal(&answers), Some(Outcome::SignalOfOtherLaw), "Subscribe checks it with any rate");
}

#[test]
fn only_reset_and_a_new_subscription_end_a_subscription() {
    let kept_after = |requests: &[&str]| {
        let mut host = host_in(State::Idle);
        host.send(Subscribe { signals: 1, every: 1 });
        for name in requests {
            assert_eq!(refusal(&host.send(request(name))), None, "{name}");
        }
        host
    };
    for requests in [
        &["Arm", "Start"][..],
        &["Arm", "Start", "Stop", "Arm", "Start"],
        &["EmergencyStop", "ClearFault", "Arm", "Start"],
        &["Hello, another session", "Hello, same session", "Arm", "Start"],
    ] {
        assert_eq!(telemetry_of(&mut kept_after(requests), 3).len(), 3, "{requests:?}");
    }
    let mut host = kept_after(&["Arm", "Start"]);
    assert!(refusal(&host.send(OF_THE_SECOND_LAW)).is_some());
    assert_eq!(telemetry_of(&mut host, 3).len(), 3, "a refused request changes nothing");

    let reset = &["Reset", "Hello, same session", "Arm", "Start"];
    assert_eq!(telemetry_of(&mut kept_after(reset), 3), []);
}

#[test]
fn a_subscription_takes_effect_from_the_next_sample() {
    let mut host = host_in(State::Running);
    assert_eq!(telemetry_of(&mut host, 2), []);
    host.send(Subscribe { signals: 1, every: 1 });
    assert_eq!(host.sample(1).len(), 1, "a repeated sample has no telemetry");
    assert_eq!(host.sample(2).len(), 2);
}
