//! Section 18: what refuses to arm in bench mode, its requests, and the faults of its events.

use std::collections::BTreeSet;
use std::time::Duration;

use lashloop_firmware::power_stage::PowerStageFault;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, EmergencyStop, Reference, Reset};
use lashloop_protocol::{DriveMessage, HostMessage};

use crate::host::{SESSION, names, refusal, rest};
use crate::markdown::{section, table};
use crate::pin_host::{PERIOD, PinHost, index};

const FAULTS: &str = "### Faults of bench mode";
const EVENTS: &str = "event in Running of bench mode";
const FURTHER_EVENTS: &str = "further event in Running of bench mode";

/// The codes of the events of bench mode.
pub fn faults() -> BTreeSet<String> {
    let rows = [EVENTS, FURTHER_EVENTS].map(|events| table(section(FAULTS), events)).concat();
    rows.iter().flat_map(|row| row[2].split(" or ").map(str::to_owned)).collect()
}

/// Makes the refusals of a case of the table, each with the detail of its answer.
fn refuse(case: &str) -> Vec<(PinHost, u32)> {
    use ParameterValue::{F32, U32};
    let with = |name, value, of: &str| (PinHost::with(&[(name, value)]), index(of).into());
    let read = |detail, happen: fn(&mut PinHost)| {
        let mut host = PinHost::with(&[]);
        happen(&mut host);
        host.tick();
        (host, detail)
    };
    match case.split([' ', ',']).next().unwrap_or_default() {
        "duty_min" => {
            vec![with("duty_min", F32(0.6), "duty_min"), with("duty_max", F32(0.4), "duty_offset")]
        }
        "a" => vec![with("torque_per_duty_nm", F32(200.0), "torque_limit_nm")],
        "the" if case.starts_with("the timer") => vec![
            with("period_us", U32(65_536), "period_us"),
            with("period_us", U32(2000), "motor_speed_limit_rad_s"),
        ],
        "the" if case.starts_with("the encoders") => vec![(PinHost::unread(), 1)],
        "the" => vec![
            read(1, |host| host.readings.stage_fault = Some(PowerStageFault::BreakInput)),
            read(2, |host| host.readings.stage_fault = Some(PowerStageFault::FaultLine)),
        ],
        "both" => vec![
            read(4, |host| host.readings.motor.illegal_transitions = 1),
            read(5, |host| host.readings.load.illegal_transitions = 1),
        ],
        "an" => vec![read(2, |host| host.turn(22_000, 0)), read(3, |host| host.turn(0, 2_500))],
        other => panic!("this test can't reach the case {other:?} of the document"),
    }
}

#[test]
fn every_case_that_refuses_to_arm_has_the_documented_outcome() {
    let rows = table(section("### Arming in bench mode"), "case");
    assert_eq!(rows.len(), 7);
    for row in rows {
        let (case, outcome, details) = (&row[0], &row[1], &row[2]);
        for (mut host, detail) in refuse(case) {
            let answers = host.send(Arm { session: SESSION });
            let [DriveMessage::CommandResult(it)] = answers[..] else { panic!("{case}: {answers:?}") };
            assert_eq!((it.outcome.to_string(), it.detail), (outcome.clone(), detail), "{case}");
            assert!(
                details.contains(&detail.to_string()) || it.outcome == Outcome::Inconsistent,
                "{case}: {detail}"
            );
            assert_eq!(it.state, State::Idle);
        }
    }
}

/// What the documents call a request of bench mode.
fn request(name: &str, host: &mut PinHost) -> HostMessage {
    match name {
        "Reference" => {
            host.number += 1;
            Reference { number: host.number, reference_rad: 0.0 }.into()
        }
        "EncoderSample" => rest(0).into(),
        other => panic!("this test can't make the request {other:?} of the document"),
    }
}

/// A drive in bench mode in this state.
fn in_state(state: State) -> PinHost {
    let mut host = match state {
        State::Running => return PinHost::running(&[]),
        _ => PinHost::with(&[]),
    };
    match state {
        State::Boot => drop(host.send(Reset {})),
        State::Armed => assert_eq!(host.arm().1, State::Armed),
        State::Faulted => drop(host.send(EmergencyStop {})),
        _ => {}
    }
    assert_eq!(host.drive.state(), state);
    host
}

#[test]
fn every_request_of_bench_mode_in_every_state_matches_the_table() {
    for row in table(section("### Requests of bench mode"), "request in bench mode") {
        for (&state, cell) in State::ALL.iter().zip(&row[1..]) {
            let mut host = in_state(state);
            let message = request(&row[0], &mut host);
            let refused = refusal(&host.send(message));
            let have = refused.map_or(format!("-> {:?}", host.drive.state()), |outcome| outcome.to_string());
            assert_eq!(have, *cell, "{} in {state}", row[0]);
        }
    }
}

#[test]
fn the_requests_of_bench_mode_get_the_documented_answers_in_order() {
    for row in table(section("### Requests of bench mode"), "request") {
        let (name, case) = (&row[0], &row[1]);
        let mut hosts = match &**case {
            "Running of bench mode" => vec![in_state(State::Running)],
            "any other state, HIL mode" => {
                let hil = PinHost::with(&[("sample_source", ParameterValue::U32(0))]);
                vec![in_state(State::Boot), in_state(State::Armed), in_state(State::Faulted), hil]
            }
            "Running, later than the watchdog allows" => {
                let mut host = in_state(State::Running);
                host.clock.advance(Duration::from_millis(21));
                vec![host]
            }
            other => panic!("this test can't reach the case {other:?} of the document"),
        };
        for host in &mut hosts {
            let message = request(name, host);
            let have = names(&host.send(message));
            assert_eq!(if have.is_empty() { "none" } else { &have }, row[2], "{name}: {case}");
        }
    }
}

/// Drives that run in bench mode, each with one of the event's causes, and the code that follows.
fn happen(event: &str) -> Vec<(FaultCode, Vec<DriveMessage>, PinHost)> {
    let after = |code, cause: fn(&mut PinHost)| {
        let mut host = PinHost::under_torque();
        cause(&mut host);
        let answers = host.tick();
        (code, answers, host)
    };
    let lost = |code, (motor, load): (i64, i64)| {
        let mut host = PinHost::running(&[("twist_limit_rad", ParameterValue::F32(0.5))]);
        let mut answers = Vec::new();
        for k in 0..9 {
            host.turn(k * motor, k * load);
            host.refer(0.0);
            answers = host.tick();
            if host.drive.state() == State::Faulted {
                break;
            }
        }
        (code, answers, host)
    };
    match event.split([' ', ',']).next().unwrap_or_default() {
        "the" if event.starts_with("the power stage") => vec![
            after(FaultCode::PowerStage, |host| {
                host.readings.stage_fault = Some(PowerStageFault::BreakInput);
            }),
            after(FaultCode::PowerStage, |host| {
                host.readings.stage_fault = Some(PowerStageFault::FaultLine);
            }),
        ],
        "the" if event.starts_with("the twist") => vec![lost(FaultCode::MotorEncoderLost, (0, 1_000))],
        "the" => vec![lost(FaultCode::LoadEncoderLost, (3_000, 0))],
        "both" => vec![
            after(FaultCode::MotorEncoderLost, |host| host.readings.motor.illegal_transitions = 1),
            after(FaultCode::LoadEncoderLost, |host| host.readings.load.illegal_transitions = 1),
        ],
        "optional:" => {
            let mut host = PinHost::running(&[]);
            host.refer(1.0);
            let (mut at, mut speed, mut answers) = (0, 0, host.tick());
            // A quarter of a load that turns with the motor, and a positive torque.
            while host.drive.state() == State::Running {
                speed -= 100;
                at += speed;
                host.turn(at * 3, at);
                host.refer(1.0);
                answers = host.tick();
            }
            vec![(FaultCode::MotorAgainstTorque, answers, host)]
        }
        "a" => {
            let mut late = PinHost::under_torque();
            let answers = late.tick_after(PERIOD + Duration::from_nanos(1));
            vec![
                (FaultCode::TickOverrun, answers, late),
                after(FaultCode::TickOverrun, |host| host.due += PERIOD),
            ]
        }
        other => panic!("this test can't cause the event {other:?} of the document"),
    }
}

#[test]
fn every_event_of_bench_mode_latches_the_documented_fault() {
    for row in table(section(FAULTS), EVENTS) {
        for (code, answers, host) in happen(&row[0]) {
            assert!(row[2].split(" or ").any(|name| name == format!("{code:?}")), "{}", row[0]);
            assert_eq!(row[1], "Faulted");
            host.assert_faulted(&answers, code);
        }
    }
}
