//! Arbitrary histories of a drive from every state.

use std::cell::RefCell;
use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::drive::{Drive, ManualClock};
use lashloop_firmware::law::{LawSet, Parameter};
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterType, ParameterValue, State};
use lashloop_protocol::frame::{Frame, MAX_BODY};
use lashloop_protocol::message::{Arm, EmergencyStop, Hello, SetParameter, Start, Subscribe};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{HostMessage, Message};
use proptest::collection::vec;
use proptest::num::f32::ANY;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{Config, RngSeed, TestError, TestRunner};

use crate::action::{self, Action};
use crate::coverage::Coverage;
use crate::invariants::{CheckedDrive, SESSION};

const TABLE: &[Parameter] = Laws::PARAMETERS;

fn request<P: Payload>(message: P) -> Action<'static> {
    let mut body = [0; MAX_BODY];
    let body = &mut body[..message.body_len()];
    message.put(1, body);
    Action::Body(body.iter().copied().collect())
}

/// The requests that lead from power-up to a state.
fn way_to(state: State, parameters: Vec<Action<'static>>) -> Vec<Action<'static>> {
    let hello = request(Hello::new(SESSION));
    let (arm, start) = (request(Arm { session: SESSION }), request(Start { session: SESSION }));
    let to_running = || [vec![hello.clone()], parameters.clone(), vec![arm.clone(), start.clone()]].concat();
    match state {
        State::Boot => Vec::new(),
        State::Idle => vec![hello],
        State::Armed => [vec![hello], parameters, vec![arm]].concat(),
        State::Running => to_running(),
        State::Faulted | State::Unknown(_) => [to_running(), vec![request(EmergencyStop {})]].concat(),
    }
}

/// An allowed value of a parameter, with extra weight on the ends of its range.
fn setting() -> impl Strategy<Value = Action<'static>> {
    (0..TABLE.len(), 0.0..=1.0_f32, 0..8_u8).prop_map(|(index, part, end)| {
        let part = match end {
            0 => 0.0,
            1 => 1.0,
            _ => part,
        };
        let range = TABLE[index].range;
        let value = match (range.min(), range.max(), range.default()) {
            (ParameterValue::U32(min), ParameterValue::U32(max), _) => {
                ParameterValue::U32(min + (f64::from(max - min) * f64::from(part)) as u32)
            }
            // Half of the values are near the default, so that many sets are consistent.
            (.., ParameterValue::F32(default)) if end >= 4 => ParameterValue::F32(default * (0.5 + part)),
            (ParameterValue::F32(min), ParameterValue::F32(max), _) => {
                ParameterValue::F32(min + (max - min) * part.powi(8))
            }
            (min, ..) => min,
        };
        request(SetParameter { index: index as u8, value })
    })
}

/// Any index, type and value.
fn wild_setting() -> impl Strategy<Value = Action<'static>> {
    let value = prop_oneof![
        any::<u32>().prop_map(ParameterValue::U32),
        ANY.prop_map(ParameterValue::F32),
        (3..=u8::MAX, any::<[u8; 4]>()).prop_map(|(ty, bytes)| match ParameterType::from_byte(ty) {
            Some(ParameterType::Unknown(ty)) => ParameterValue::Unknown { ty, bytes },
            other => panic!("{other:?}"),
        }),
    ];
    (0..TABLE.len() as u8 + 2, value).prop_map(|(index, value)| request(SetParameter { index, value }))
}

/// Any signals; half of them every law of the drive has, and some only one of them.
fn subscription() -> impl Strategy<Value = Action<'static>> {
    let every_law = (1 << Laws::NAMES.len()) - 1;
    let common = (0..).zip(Laws::SIGNALS).filter(|(_, signal)| signal.laws == every_law);
    let common: u32 = common.map(|(index, _)| 1 << index).sum();
    let known = (1 << Laws::SIGNALS.len()) - 1;
    let signals = prop_oneof![
        4 => any::<u32>().prop_map(move |bits| bits & common),
        1 => any::<u32>().prop_map(move |bits| bits & known),
        3 => any::<u32>(),
    ];
    (signals, 0..5_u16).prop_map(|(signals, every)| request(Subscribe { signals, every }))
}

/// A message with any fields; some are of a newer version, and longer.
fn host_body() -> impl Strategy<Value = Action<'static>> {
    let more = prop_oneof![3 => Just(0), 1 => 1..9_usize];
    (select(HostMessage::LAYOUTS), vec(any::<u8>(), 64), any::<bool>(), more).prop_map(
        |(layout, bytes, present, more)| {
            let fields = bytes[..layout.body_len - 1].iter();
            let mut body: action::Body = [&layout.kind].into_iter().chain(fields).copied().collect();
            if present && layout.fields.last().is_some_and(|field| field.name == "session") {
                let at = body.len() - 4;
                body[at..].copy_from_slice(&SESSION.to_le_bytes());
            }
            body.extend(bytes[..more].iter().copied());
            Action::Body(body)
        },
    )
}

/// A request that this version doesn't know.
fn newer_request() -> impl Strategy<Value = Action<'static>> {
    (0x12..0x80_u8, vec(any::<u8>(), 0..9))
        .prop_map(|(kind, rest)| Action::Body([kind].into_iter().chain(rest).collect()))
}

fn sample() -> impl Strategy<Value = Action<'static>> {
    let counts = || prop_oneof![6 => -300..300_i16, 1 => any::<i16>()];
    let reference = prop_oneof![9 => -2.0..2.0_f32, 1 => ANY];
    (counts(), counts(), reference).prop_map(|(motor, load, reference_rad)| Action::Sample {
        motor,
        load,
        reference_rad,
    })
}

fn action() -> impl Strategy<Value = Action<'static>> {
    prop_oneof![
        12 => sample(),
        4 => host_body(),
        2 => setting(),
        1 => wild_setting(),
        1 => subscription(),
        1 => newer_request(),
        1 => vec(any::<u8>(), 0..9).prop_map(|body| Action::Body(body.into_iter().collect())),
        1 => vec(any::<u8>(), 0..200).prop_map(|line| Action::Line(line.into())),
        3 => (0..2_000_u64).prop_map(|us| Action::Elapse(Duration::from_micros(us))),
        1 => any::<u32>().prop_map(|us| Action::Elapse(Duration::from_micros(us.into()))),
        1 => any::<u8>().prop_map(Action::Overruns),
        3 => Just(Action::Drain),
        1 => select(State::ALL).prop_map(Action::Enter),
    ]
}

fn history() -> impl Strategy<Value = Vec<Action<'static>>> {
    (select(State::ALL), vec(prop_oneof![4 => setting(), 1 => subscription()], 0..6), vec(action(), 0..80))
        .prop_map(|(state, parameters, actions)| [way_to(state, parameters), actions].concat())
}

/// The same cases in every run; `cargo xtask test fuzz` looks for new ones.
fn config(cases: u32) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(0x1a54_100b), failure_persistence: None, ..Config::default() }
}

fn run(history: &[Action<'_>]) -> Coverage {
    let mut drive = CheckedDrive::<Coverage>::new();
    history.iter().for_each(|action| drive.act(action));
    drive.observer
}

#[test]
fn no_history_violates_an_invariant() {
    let reached = RefCell::new(Coverage::default());
    let outcome = TestRunner::new(config(10_000)).run(&history(), |history| {
        let coverage = run(&history);
        let mut reached = reached.borrow_mut();
        reached.states.extend(coverage.states);
        reached.faults.extend(coverage.faults);
        reached.outcomes.extend(coverage.outcomes);
        reached.torques += coverage.torques;
        reached.telemetry += coverage.telemetry;
        reached.full += coverage.full;
        Ok(())
    });
    if let Err(TestError::Fail(reason, history)) = outcome {
        panic!("{reason} after {history:#?}");
    }

    // The histories must reach every state, fault and outcome to prove the invariants.
    let reached = reached.into_inner();
    assert!(State::ALL.iter().all(|state| reached.states.contains(state)));
    // Of a halt, and of bench mode, which this drive doesn't offer.
    let is_never = |code: FaultCode| {
        matches!(code, FaultCode::Panic | FaultCode::ProcessorFault)
            || code.byte() >= FaultCode::PowerStage.byte()
    };
    let missing: Vec<_> =
        FaultCode::ALL.iter().filter(|code| !reached.faults.contains(code) && !is_never(**code)).collect();
    assert!(missing.is_empty(), "no history led to {missing:?}");
    let of_bench_mode =
        [Outcome::PowerStageFault, Outcome::EncoderImplausible, Outcome::StoreFailed, Outcome::NotCaptured];
    let missing: Vec<_> = Outcome::ALL
        .iter()
        .filter(|outcome| !reached.outcomes.contains(outcome) && !of_bench_mode.contains(outcome))
        .collect();
    assert!(missing.is_empty(), "no history led to {missing:?}");
    assert!(reached.torques > 10_000, "{} torques", reached.torques);
    assert!(reached.telemetry > 500, "{} messages of telemetry", reached.telemetry);
    assert!(reached.full > 100, "the output was full {} times", reached.full);
}

proptest! {
    #![proptest_config(config(2000))]

    /// The input of the fuzzer.
    #[test]
    fn any_bytes_are_a_history_without_violation(bytes in vec(any::<u8>(), 0..3000)) {
        let mut rest = &bytes[..];
        run(&std::iter::from_fn(|| Action::read(&mut rest)).collect::<Vec<_>>());
        prop_assert!(rest.is_empty());
    }

    /// The decoder buffers a partial frame, so input may be cut anywhere.
    #[test]
    fn the_cut_of_the_input_does_not_change_the_answers(history in history(), pieces in vec(1..70_usize, 1..9)) {
        // Without elapsed time and overruns: bytes only.
        let line: Vec<u8> = history.iter().flat_map(bytes_of).collect();
        prop_assert_eq!(answers(&line, &[line.len().max(1)]), answers(&line, &pieces));
    }
}

fn bytes_of(action: &Action<'_>) -> Vec<u8> {
    match action {
        Action::Line(bytes) => bytes.to_vec(),
        Action::Body(body) => Frame::around(body).to_vec(),
        _ => Vec::new(),
    }
}

fn answers(line: &[u8], piece_lens: &[usize]) -> Vec<u8> {
    let mut drive = Drive::new("pieces");
    let (mut sent, mut rest) = (Vec::new(), line);
    for &len in piece_lens.iter().cycle() {
        if rest.is_empty() {
            break;
        }
        let used = drive.receive(&rest[..len.min(rest.len())], &ManualClock::default());
        rest = &rest[used..];
        sent.extend_from_slice(drive.output());
        drive.clear_output();
    }
    sent
}
