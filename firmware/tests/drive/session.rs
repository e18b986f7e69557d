//! Sessions: handshake, arming, stopping.

use lashloop_firmware::drive::{BUILD_ID, BUILD_IS_DIRTY};
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, ClearFault, EmergencyStop, GetParameter, Hello, Reset, Start, Stop};
use lashloop_protocol::{DriveMessage, HostMessage, MINOR_VERSION, Message, PROTOCOL_VERSION};

use crate::host::{HELLO, Host, SESSION, torque};

#[test]
fn a_drive_sends_nothing_unasked_after_power_up() {
    assert_eq!(Host::new().take_output(), []);
}

#[test]
fn hello_ends_boot_and_returns_the_identity() {
    let mut host = Host::new();
    let identity = host.identity(HELLO);
    assert_eq!((identity.session, identity.state, identity.build_id), (SESSION, State::Idle, BUILD_ID));
    assert_eq!(identity.dirty, u8::from(BUILD_IS_DIRTY));
    assert_eq!((identity.law_count, identity.signal_count, identity.parameter_count), (6, 12, 55));
    assert_eq!(identity.board.as_str(), "test");
    assert_eq!((identity.protocol_version, identity.minor_version), (PROTOCOL_VERSION, MINOR_VERSION));
}

#[test]
fn another_protocol_version_is_rejected_with_the_identity() {
    let mut host = Host::new();
    let hello = Hello { protocol_version: 9, ..HELLO };
    assert_eq!(host.identity(hello).protocol_version, PROTOCOL_VERSION);
    assert_eq!(host.command(hello), (Outcome::VersionMismatch, State::Boot));
    assert_eq!(host.command(Arm { session: SESSION }), (Outcome::WrongSession, State::Boot));
}

#[test]
fn samples_are_rejected_in_boot() {
    let mut host = Host::new();
    let sample = crate::host::sample(0, 0, 0);
    assert_eq!(host.command(sample), (Outcome::WrongState, State::Boot));
}

/// Every request in every state: its outcome and the state afterwards.
#[test]
fn the_table_of_transitions_is_complete() {
    type Enter = fn() -> Host;
    let boot: Enter = Host::new;
    let idle: Enter = Host::idle;
    let armed: Enter = || {
        let mut host = Host::idle();
        host.send(Arm { session: SESSION });
        host
    };
    let running: Enter = || Host::running(&[]);
    let faulted: Enter = || {
        let mut host = Host::idle();
        host.send(EmergencyStop {});
        host
    };
    let requests: [(&str, HostMessage); 6] = [
        ("Arm", Arm { session: SESSION }.into()),
        ("Start", Start { session: SESSION }.into()),
        ("Stop", Stop {}.into()),
        ("EmergencyStop", EmergencyStop {}.into()),
        ("ClearFault", ClearFault {}.into()),
        ("Reset", Reset {}.into()),
    ];
    let mut table = format!("{:<9}", "");
    for (name, _) in &requests {
        table += &format!("{name:<22}");
    }
    for (state, enter) in
        [("Boot", boot), ("Idle", idle), ("Armed", armed), ("Running", running), ("Faulted", faulted)]
    {
        table += &format!("\n{state:<9}");
        for (_, request) in &requests {
            let mut host = enter();
            let (outcome, after) = host.command(*request);
            let cell =
                if outcome == Outcome::Accepted { format!("-> {after:?}") } else { format!("{outcome:?}") };
            table += &format!("{cell:<22}");
            assert_eq!(host.drive.state(), after);
        }
    }
    insta::assert_snapshot!(table);
}

#[test]
fn arm_and_start_of_another_session_are_rejected() {
    let mut host = Host::idle();
    assert_eq!(host.command(Arm { session: SESSION + 1 }), (Outcome::WrongSession, State::Idle));
    host.send(Arm { session: SESSION });
    assert_eq!(host.command(Start { session: SESSION + 1 }), (Outcome::WrongSession, State::Armed));
}

#[test]
fn a_repeated_hello_keeps_the_run_and_a_new_session_disarms() {
    let mut host = Host::running(&[]);
    host.sample(0, 1000, 1000);
    assert_eq!(host.identity(HELLO).state, State::Running);
    assert_ne!(host.drive.torque_nm(), 0.0);
    assert_eq!(host.identity(Hello { session: SESSION + 1, ..HELLO }).state, State::Idle);
    assert_eq!(host.drive.torque_nm(), 0.0);
}

#[test]
fn reset_restores_the_default_parameters() {
    let mut host = Host::idle();
    let changed = host.set("torque_limit_nm", ParameterValue::F32(5.0));
    assert_eq!(changed.value, ParameterValue::F32(5.0));
    host.send(Reset {});
    host.send(HELLO);
    let index = changed.index;
    let answers = host.send(GetParameter { index });
    assert!(
        matches!(answers[0], DriveMessage::ParameterReport(r) if r.value == ParameterValue::F32(20.0)),
        "{answers:?}"
    );
}

#[test]
fn an_idle_drive_answers_samples_with_zero_torque() {
    let mut host = Host::idle();
    let answer = torque(&host.sample(41, 5000, -5000));
    assert_eq!((answer.sequence, answer.torque_nm, answer.status.state), (41, 0.0, State::Idle));
}

#[test]
fn every_request_of_a_long_burst_is_answered() {
    let mut host = Host::idle();
    let stream: Vec<u8> = (0..100).flat_map(|_| HostMessage::from(HELLO).frame().to_vec()).collect();
    assert_eq!(host.send_bytes(&stream).len(), 100);
}

#[test]
fn a_full_output_buffer_stalls_reception_without_loss() {
    let mut host = Host::idle();
    let hello = HostMessage::from(HELLO).frame();
    let taken = (0..100).take_while(|_| host.drive.receive(&hello, &host.clock) == hello.len()).count();
    assert!((1..100).contains(&taken), "the drive takes no more bytes after {taken} frames");
    assert_eq!(host.take_output().len(), taken);
    assert_eq!(host.send_bytes(&hello).len(), 1);
}
