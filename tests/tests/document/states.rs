//! The table of transitions, cell by cell.

use std::collections::BTreeSet;
use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{FaultCode, ParameterFlags, ParameterValue, State};
use lashloop_protocol::message::{DescribeParameter, EncoderSample};
use lashloop_protocol::{DriveMessage, EncoderCounts};

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
            if name == "SetParameter, live" {
                continue; // See `no_parameter_of_the_lashloop_drive_is_live`.
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

/// The row of live parameters is therefore that of other drives: its cells hold for the Python drive.
#[test]
fn no_parameter_of_the_lashloop_drive_is_live() {
    for index in 0..Laws::PARAMETERS.len() as u8 {
        match Host::in_state(State::Idle).send(DescribeParameter { index })[..] {
            [DriveMessage::ParameterDescription(description)] => {
                assert!(!description.flags.contains(ParameterFlags::LIVE), "{}", description.name);
            }
            ref other => panic!("{other:?}"),
        }
    }
}

#[test]
fn the_table_has_every_kind_of_request() {
    use lashloop_protocol::{HostMessage, Message};
    let rows = table(section(STATES), "request");
    let have: BTreeSet<_> = rows.iter().filter_map(|row| row[0].split(',').next()).collect();
    let all = HostMessage::LAYOUTS.iter().map(|layout| layout.name);
    // Of sections 18 and 19, which are optional.
    let want: BTreeSet<_> = all.filter(|name| !["Reference", "EnterLoader"].contains(name)).collect();
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

#[test]
fn every_event_latches_the_documented_fault() {
    let rows = table(section(STATES), "event in Running");
    for row in &rows {
        let code = FaultCode::ALL.iter().find(|code| format!("{code:?}") == row[2]);
        let code = *code.unwrap_or_else(|| panic!("{} isn't a fault", row[2]));
        let (host, answers) = happen(code);
        assert_eq!(format!("{:?}", host.drive.state()), row[1], "{code:?}");
        assert!(
            matches!(answers.last(), Some(DriveMessage::FaultReport(report)) if report.code == code),
            "{code:?}: {answers:?}"
        );
    }
    let not_events = [FaultCode::EmergencyStop, FaultCode::Panic, FaultCode::ProcessorFault];
    assert_eq!(
        rows.len() + not_events.len() + bench_mode::faults().len(),
        FaultCode::ALL.len(),
        "the table has every fault without a request"
    );
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
