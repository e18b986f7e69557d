//! Section 18: the parameters of bench mode, its requests, and the faults of its events.

use std::collections::BTreeSet;
use std::time::Duration;

use lashloop_firmware::drive::PinParameters;
use lashloop_firmware::law::ParameterGroup;
use lashloop_firmware::power_stage::PowerStageFault;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::Arm;
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use crate::host::SESSION;
use crate::markdown::{section, table};
use crate::pin_host::{PERIOD, PinHost};

pub const BENCH_MODE: &str = "## 18. Bench mode";
const EVENTS: &str = "event in Running of bench mode";

/// The codes of the events of bench mode.
pub fn faults() -> BTreeSet<String> {
    let rows = table(section(BENCH_MODE), EVENTS);
    rows.iter().flat_map(|row| row[2].split(" or ").map(str::to_owned)).collect()
}

#[test]
fn the_table_of_parameters_of_bench_mode_matches_the_drive() {
    let rows = table(section(BENCH_MODE), "name");
    assert_eq!(rows.len(), PinParameters::TABLE.len());
    for (row, parameter) in rows.iter().zip(PinParameters::TABLE) {
        let range = parameter.range;
        let want = [
            parameter.name.to_owned(),
            format!("{:?}", range.default().ty()),
            range.default().to_string(),
            range.min().to_string(),
            range.max().to_string(),
            parameter.unit.to_owned(),
        ];
        assert_eq!(row[..6], want);
        for name in range.choices().unwrap_or_default() {
            assert!(row[6].contains(name), "{} has the choice {name}", parameter.name);
        }
    }
}

#[test]
fn the_mode_has_the_kinds_that_no_other_section_has() {
    let states = table(section("## 6. States"), "request");
    let requests: BTreeSet<_> = states.iter().filter_map(|row| row[0].split(',').next()).collect();
    let further: Vec<_> =
        HostMessage::LAYOUTS.iter().map(|it| it.name).filter(|name| !requests.contains(name)).collect();
    assert_eq!(further, ["Reference", "EnterLoader"]);
    assert!(section(BENCH_MODE).contains("A `Reference` in `Running` gets no answer"));
}

/// Makes the refusals of the table, in its order.
fn refuse(case: &str) -> Vec<PinHost> {
    use ParameterValue::{F32, U32};
    let with = |name, value| PinHost::with(&[(name, value)]);
    let read = |happen: fn(&mut PinHost)| {
        let mut host = PinHost::with(&[]);
        happen(&mut host);
        host.tick();
        host
    };
    match case.split([' ', ',']).next().unwrap_or_default() {
        "duty_min" => vec![with("duty_min", F32(0.6)), with("duty_max", F32(0.4))],
        "a" => vec![with("torque_per_duty_nm", F32(200.0))],
        "the" if case.starts_with("the timer") => {
            vec![with("period_us", U32(65_536)), with("period_us", U32(2000))]
        }
        "the" if case.starts_with("the encoders") => vec![PinHost::unread()],
        "the" => {
            let fault = |fault| {
                let mut host = PinHost::with(&[]);
                host.readings.stage_fault = Some(fault);
                host.tick();
                host
            };
            vec![fault(PowerStageFault::BreakInput), fault(PowerStageFault::FaultLine)]
        }
        "both" => vec![
            read(|host| host.readings.motor.illegal_transitions = 1),
            read(|host| host.readings.load.illegal_transitions = 1),
        ],
        "an" => vec![read(|host| host.turn(22_000, 0)), read(|host| host.turn(0, 2_500))],
        other => panic!("this test can't reach the case {other:?} of the document"),
    }
}

#[test]
fn every_case_that_refuses_to_arm_has_the_documented_outcome() {
    let rows = table(section(BENCH_MODE), "case");
    assert_eq!(rows.len(), 7);
    for row in rows {
        for mut host in refuse(&row[0]) {
            let answers = host.send(Arm { session: SESSION });
            let [DriveMessage::Log(_), DriveMessage::CommandResult(result)] = answers[..] else {
                panic!("{}: {answers:?}", row[0])
            };
            assert_eq!(format!("{:?}", result.outcome), row[1], "{}", row[0]);
            assert_eq!(result.state, State::Idle);
            assert_ne!(result.outcome, Outcome::Accepted);
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
        "the" if event.starts_with("the break") => vec![
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
    for row in table(section(BENCH_MODE), EVENTS) {
        for (code, answers, host) in happen(&row[0]) {
            assert!(row[2].split(" or ").any(|name| name == format!("{code:?}")), "{}", row[0]);
            assert_eq!(row[1], "Faulted");
            host.assert_faulted(&answers, code);
        }
    }
}
