//! Greeting, arming, stopping.

use lashloop_firmware::drive::BUILD_ID;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, ClearFault, EmergencyStop, Hello, Reset, Start, Stop};
use lashloop_protocol::{DriveMessage, HostMessage, Message, PROTOCOL_VERSION};

use crate::host::{Host, SESSION, fault, torque};

const HELLO: Hello = Hello { protocol_version: PROTOCOL_VERSION, session: SESSION };

#[test]
fn a_drive_says_nothing_until_spoken_to() {
    assert_eq!(Host::new().listen(), []);
}

#[test]
fn hello_ends_boot_and_tells_who_is_there() {
    let mut host = Host::new();
    let identity = host.identity(HELLO);
    assert_eq!((identity.session, identity.state, identity.build_id), (SESSION, State::Idle, BUILD_ID));
    assert_eq!(identity.board.as_str(), "test");
    assert_eq!(identity.protocol_version, PROTOCOL_VERSION);
}

#[test]
fn another_protocol_version_is_refused_and_both_are_named() {
    let mut host = Host::new();
    let hello = Hello { protocol_version: 9, session: SESSION };
    assert_eq!(host.identity(hello).protocol_version, PROTOCOL_VERSION);
    assert_eq!(host.command(hello), (Outcome::VersionMismatch, State::Boot));
    assert_eq!(host.command(Arm { session: SESSION }), (Outcome::WrongSession, State::Boot));
}

#[test]
fn before_the_greeting_samples_are_refused() {
    let mut host = Host::new();
    let sample = crate::host::sample(0, 0, 0);
    assert_eq!(host.command(sample), (Outcome::WrongState, State::Boot));
}

/// Every request in every state: what is done, and where it leads.
#[test]
fn the_table_of_transitions_is_complete() {
    type Enter = fn() -> Host;
    let boot: Enter = Host::new;
    let idle: Enter = Host::idle;
    let armed: Enter = || {
        let mut host = Host::idle();
        host.say(Arm { session: SESSION });
        host
    };
    let running: Enter = || Host::running(&[]);
    let faulted: Enter = || {
        let mut host = Host::idle();
        host.say(EmergencyStop {});
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
            let done =
                if outcome == Outcome::Accepted { format!("-> {after:?}") } else { format!("{outcome:?}") };
            table += &format!("{done:<22}");
            assert_eq!(host.drive.state(), after);
        }
    }
    insta::assert_snapshot!(table);
}

#[test]
fn a_stale_arm_or_start_of_another_session_does_nothing() {
    let mut host = Host::idle();
    assert_eq!(host.command(Arm { session: SESSION + 1 }), (Outcome::WrongSession, State::Idle));
    host.say(Arm { session: SESSION });
    assert_eq!(host.command(Start { session: SESSION + 1 }), (Outcome::WrongSession, State::Armed));
}

#[test]
fn the_same_hello_again_leaves_the_run_alone_and_a_new_one_disarms() {
    let mut host = Host::running(&[]);
    host.sample(0, 1000, 1000);
    assert_eq!(host.identity(HELLO).state, State::Running);
    assert_ne!(host.drive.torque_nm(), 0.0);
    assert_eq!(host.identity(Hello { session: SESSION + 1, ..HELLO }).state, State::Idle);
    assert_eq!(host.drive.torque_nm(), 0.0);
}

#[test]
fn a_latched_fault_survives_a_new_session_and_is_told_again() {
    let mut host = Host::running(&[]);
    host.say(EmergencyStop {});
    let answers = host.say(Hello { session: SESSION + 1, ..HELLO });
    assert!(matches!(answers[0], DriveMessage::Identity(identity) if identity.state == State::Faulted));
    assert_eq!(fault(&answers).code, FaultCode::EmergencyStop);
}

#[test]
fn parameters_that_do_not_go_together_are_refused_when_arming() {
    let mut host = Host::idle();
    host.set("controller", ParameterValue::U32(2));
    host.set("dead_zone_max_rad", ParameterValue::F32(0.1));
    let answers = host.say(Arm { session: SESSION });
    assert!(
        matches!(&answers[0], DriveMessage::Log(log) if log.text.as_str() == "dead_zone_initial_rad does not go with the others"),
        "{answers:?}"
    );
    assert_eq!(host.command(Arm { session: SESSION }), (Outcome::Inconsistent, State::Idle));
}

#[test]
fn reset_brings_back_the_defaults() {
    let mut host = Host::idle();
    let changed = host.set("torque_limit_nm", ParameterValue::F32(5.0));
    assert_eq!(changed.value, ParameterValue::F32(5.0));
    host.say(Reset {});
    host.say(HELLO);
    let index = changed.index;
    let answers = host.say(lashloop_protocol::message::GetParameter { index });
    assert!(
        matches!(answers[0], DriveMessage::ParameterReport(r) if r.value == ParameterValue::F32(20.0)),
        "{answers:?}"
    );
}

#[test]
fn a_drive_that_is_not_running_answers_samples_with_no_torque() {
    let mut host = Host::idle();
    let answer = torque(&host.sample(41, 5000, -5000));
    assert_eq!((answer.sequence, answer.torque_nm, answer.status.state), (41, 0.0, State::Idle));
}

#[test]
fn requests_of_any_number_in_one_piece_are_all_answered() {
    let mut host = Host::idle();
    let stream: Vec<u8> = (0..100).flat_map(|_| HostMessage::from(HELLO).frame().to_vec()).collect();
    assert_eq!(host.send(&stream).len(), 100);
}

#[test]
fn an_owner_that_does_not_send_is_made_to_before_anything_is_lost() {
    let mut host = Host::idle();
    let hello = HostMessage::from(HELLO).frame();
    let taken = (0..100).take_while(|_| host.drive.receive(&hello, &host.clock) == hello.len()).count();
    assert!((1..100).contains(&taken), "the drive stops taking bytes, after {taken} frames");
    assert_eq!(host.listen().len(), taken);
    assert_eq!(host.send(&hello).len(), 1);
}
