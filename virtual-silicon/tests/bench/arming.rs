//! Refusals to arm that come from the pins.

use std::time::Duration;

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{Arm, Reset};

use crate::bench::image;
use crate::host::{Host, SESSION};

const MS: Duration = Duration::from_millis(1);

fn assert_off(host: &mut Host) {
    host.bench.advance(3 * MS);
    assert!(!host.bench.bridge().is_on());
}

#[test]
fn a_break_input_that_is_active_or_open_refuses_to_arm() {
    let mut host = Host::idle(&image(), &[]);
    for level in [Some(true), None] {
        host.bench.act(move |chip, _| chip.drive_break(level));
        host.bench.advance(2 * MS);
        // The break input.
        assert_eq!(host.refusal_to_arm(), (Outcome::PowerStageFault, 1));
        assert_off(&mut host);
    }
    host.bench.act(|chip, _| chip.drive_break(Some(false)));
    host.bench.advance(2 * MS);
    host.run();
}

#[test]
fn an_encoder_faster_than_its_limit_refuses_to_arm() {
    let mut host = Host::idle(&image(), &[]);
    // 2.1 million counts per second are the limit of the load.
    host.bench.turn(0.0, 4e6);
    host.bench.advance(3 * MS);
    host.bench.turn(0.0, 0.0);
    host.bench.advance(3 * MS);
    // The load encoder, too fast.
    assert_eq!(host.refusal_to_arm(), (Outcome::EncoderImplausible, 3));
    assert_off(&mut host);
    host.command(Reset {});
    host.shake_hands(SESSION);
    host.set_all(&[]);
    host.bench.advance(2 * MS);
    host.run();
}

#[test]
fn without_its_session_a_drive_does_not_arm() {
    let mut host = Host::idle(&image(), &[]);
    assert_eq!(host.command(Arm { session: SESSION + 1 }), (Outcome::WrongSession, State::Idle));
    host.command(Reset {});
    assert_eq!(host.arm(), (Outcome::WrongSession, State::Boot));
    assert_off(&mut host);
}

#[test]
fn a_break_that_ends_before_the_next_tick_is_reported() {
    let mut host = Host::under_torque(&image(), Duration::from_millis(1));
    for level in [true, false] {
        host.bench.act(move |chip, _| chip.drive_break(Some(level)));
        host.bench.advance(Duration::from_micros(5));
    }
    host.steps(3, 1.0);
    let codes: Vec<_> = host.faults().iter().map(|fault| fault.code).collect();
    assert_eq!(codes, [lashloop_protocol::enums::FaultCode::PowerStage]);
    assert!(!host.bench.bridge().is_on());
}
