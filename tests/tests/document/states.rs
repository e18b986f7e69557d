//! The table of transitions, cell by cell.

use std::collections::BTreeSet;
use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{FaultCode, ParameterFlags, ParameterValue, State};
use lashloop_protocol::message::{DescribeParameter, EncoderSample};
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage, Message};

use crate::bench_mode;
use crate::host::{Host, refusal, request, rest};
use crate::markdown::{section, table};

const STATES: &str = "## 6. States";

#[test]
fn every_request_in_every_state_matches_the_table() {
    for row in table(section(STATES), "request") {
        let (name, cells) = (&row[0], &row[1..]);
        assert_eq!(cells.len(), State::ALL.len(), "{name}");
        for (&state, cell) in State::ALL.iter().zip(cells) {
            if cell == "no session yet" {
                assert_eq!(state, State::Boot);
                continue;
            }
            let mut host = Host::in_state(state);
            if state == State::Running {
                let [motor_counts, load_counts] = [3000, 1000].map(EncoderCounts::wrapping);
                host.send(EncoderSample { motor_counts, load_counts, ..rest(0) });
                assert_ne!(host.drive.torque_nm(), 0.0, "the drive gives torque before the request");
            }
            let refused = refusal(&host.send(request(name)));
            let after = host.drive.state();
            let have = match refused {
                None => format!("-> {after:?}"),
                Some(outcome) => {
                    assert_eq!(after, state, "{name} was refused in {state:?} and moved the drive");
                    format!("{outcome:?}")
                }
            };
            assert_eq!(have, *cell, "{name} in {state:?}");
            assert!(after == State::Running || host.drive.torque_nm() == 0.0, "{name} in {state:?}");
        }
    }
}

#[test]
fn the_gains_of_the_cascade_are_live_and_no_other_parameter() {
    let mut live = Vec::new();
    for index in 0..Laws::PARAMETERS.len() as u8 {
        match Host::in_state(State::Idle).send(DescribeParameter { index })[..] {
            [DriveMessage::ParameterDescription(it)] if it.flags.contains(ParameterFlags::LIVE) => {
                live.push(it.name.as_str().to_owned());
            }
            [DriveMessage::ParameterDescription(_)] => {}
            ref other => panic!("{other:?}"),
        }
    }
    assert_eq!(live, ["k_p1", "k_d1", "k_p2", "k_d2", "k_1"]);
}

#[test]
fn the_tables_have_every_kind_of_request() {
    let of = |heading, header| table(section(heading), header).into_iter().map(|row| row[0].clone());
    let rows = of(STATES, "request")
        .chain(of("### Requests of bench mode", "request in bench mode"))
        .chain(of("## 19. Boot loader", "request with a boot loader"))
        .chain(of("## 20. Stored parameters", "request with stored parameters"))
        .chain(of("## 21. Zero of the encoders", "request with encoders"))
        .chain(of("## 22. Capture", "request with captures"));
    let have: BTreeSet<_> = rows.filter_map(|row| row.split(',').next().map(str::to_owned)).collect();
    let want: BTreeSet<_> = HostMessage::LAYOUTS.iter().map(|layout| layout.name.to_owned()).collect();
    assert_eq!(have, want);
}

#[test]
fn a_fault_before_any_handshake_clears_to_boot() {
    let mut host = Host::in_state(State::Boot);
    host.send(request("EmergencyStop"));
    host.send(request("ClearFault"));
    assert_eq!(host.drive.state(), State::Boot);
}

/// Causes a documented fault in a running drive; returns the host and the answers.
fn happen(code: FaultCode) -> (Host, Vec<DriveMessage>) {
    let far = |motor, load| {
        let [motor_counts, load_counts] = [motor, load].map(EncoderCounts::wrapping);
        EncoderSample { motor_counts, load_counts, ..rest(1) }
    };
    let mut host = Host::running(&[("k_p1", ParameterValue::F32(1e6)), ("k_p2", ParameterValue::F32(1e6))]);
    host.sample(0);
    let answers = match code {
        FaultCode::Watchdog => {
            host.wait(Duration::from_micros(20_001));
            host.tick()
        }
        FaultCode::TorqueNotFinite => host.send(EncoderSample { reference_rad: f32::MAX, ..rest(1) }),
        FaultCode::ReferenceNotFinite => host.send(EncoderSample { reference_rad: f32::NAN, ..rest(1) }),
        FaultCode::MotorEncoderJump => host.send(far(1 << 20, 0)),
        FaultCode::LoadEncoderJump => host.send(far(0, 1 << 20)),
        other => panic!("{other:?} needs a request"),
    };
    (host, answers)
}

/// The faults of the sentence with the tag of the rule.
fn faults_of_events() -> BTreeSet<String> {
    let paragraph = section(STATES).split("\n\n").find(|text| text.contains("[R6.9]")).expect("a rule");
    let words = paragraph.split('`').skip(1).step_by(2);
    words.filter(|word| !["Running", "Faulted"].contains(word)).map(str::to_owned).collect()
}

#[test]
fn every_event_latches_the_documented_fault() {
    let events = faults_of_events();
    let faults = || FaultCode::ALL.iter().map(|code| (*code, format!("{code:?}")));
    for (code, _) in faults().filter(|(_, name)| events.contains(name)) {
        let (host, answers) = happen(code);
        assert_eq!(host.drive.state(), State::Faulted, "{code:?}");
        assert!(
            matches!(answers.last(), Some(DriveMessage::FaultReport(report)) if report.code == code),
            "{code:?}: {answers:?}"
        );
    }
    let requested = ["EmergencyStop", "Panic", "ProcessorFault"].map(str::to_owned);
    let documented: BTreeSet<_> = requested.into_iter().chain(bench_mode::faults()).chain(events).collect();
    assert_eq!(documented, faults().map(|(_, name)| name).collect(), "every fault has a cause");
}

#[test]
fn a_silence_of_exactly_the_watchdog_time_is_in_time() {
    let mut host = Host::running(&[]);
    host.wait(Duration::from_micros(20_000));
    assert_eq!(host.tick(), []);
    assert_eq!(host.drive.state(), State::Running);
}

#[test]
fn an_emergency_stop_is_reported_and_the_first_fault_kept() {
    let (mut host, _) = happen(FaultCode::Watchdog);
    let answers = host.send(request("EmergencyStop"));
    assert!(
        matches!(answers[0], DriveMessage::FaultReport(report) if report.code == FaultCode::EmergencyStop),
        "{answers:?}"
    );
    let answers = host.send(request("Hello, same session"));
    assert!(
        matches!(answers[1], DriveMessage::FaultReport(report) if report.code == FaultCode::Watchdog),
        "{answers:?}"
    );
}
