//! The images of all boards: those with a break input stop at it; an ODrive has a gate driver and a bridge of its own instead.

use std::time::Duration;

use lashloop_protocol::enums::{FaultCode, Outcome, State};
use lashloop_protocol::message::{ClearFault, Stop};
use lashloop_silicon::boards::{self, BUILT_IN};
use lashloop_silicon::wiring::Encoder;

use crate::bench::{image_of, odrive_image};
use crate::host::{Host, SESSION};
use crate::time_to_off::of_each;

/// Dead time of 20 cycles of 168 MHz, as a fraction of the period of 50 us.
const DEAD_TIME: f64 = 20.0 / 8_400.0;
/// A nanosecond of each pulse, and a cycle.
const RESOLUTION: f64 = 2.0 / 50_000.0 + 1.0 / 8_400.0;

fn idle() -> Host {
    let mut host = Host::at(&odrive_image(), (0, 0));
    host.set_all(&[]);
    host
}

#[test]
fn an_odrive_boots_with_its_gates_off_and_reports_its_board() {
    let mut host = idle();
    assert_eq!(host.shake_hands(SESSION).board.as_str(), "odrive-v3");
    assert_eq!(host.bench.act(|chip, _| chip.misconfigured()), [""; 0]);
    let wiring = boards::open("odrive-v3").expect("the board");
    let select = wiring.gate_driver.expect("a gate driver").select;
    for (pins, is_high) in [(wiring.high, true), (vec![select], true), (wiring.bridge.unused_gates, false)] {
        for pin in pins {
            assert_eq!(host.bench.act(move |chip, _| chip.is_high(pin)), is_high, "{pin}");
        }
    }
    let (bridge, levels) = host.bench.act(|chip, _| (chip.bridge(), chip.output_levels()));
    assert_eq!((bridge.duty, bridge.has_main_output, levels.0), (None, false, Some(false)));
    assert!(bridge.is_enabled, "EN_GATE is high from the start");
}

#[test]
fn an_odrive_drives_two_half_bridges_against_each_other() {
    let mut host = idle();
    host.run();
    for reference_rad in [0.0, 0.2, -0.4] {
        let sample = *host.steps(3, reference_rad).last().expect("samples");
        let duty = 0.5 + f64::from(sample.torque_nm) / 100.0;
        let halves = host.bench.act(|chip, _| chip.half_bridges());
        assert_eq!(halves.len(), 2);
        for ([high, low], duty) in halves.into_iter().zip([duty, 1.0 - duty]) {
            let (high, low) = (high.expect("a pulse"), low.expect("a pulse"));
            assert!((high - (duty - DEAD_TIME)).abs() < RESOLUTION, "{reference_rad} rad: {high}, {duty}");
            assert!(
                (low - (1.0 - duty - DEAD_TIME)).abs() < RESOLUTION,
                "{reference_rad} rad: {low}, {duty}"
            );
        }
    }
    assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
    let halves = host.bench.act(|chip, _| chip.half_bridges());
    assert_eq!(halves, [[None; 2]; 2]);
}

#[test]
fn an_odrive_counts_its_encoders() {
    let mut host = idle();
    host.run();
    host.bench.turn(900e3, 300e3);
    host.steps(10, 0.0);
    host.bench.turn(0.0, 0.0);
    let sample = *host.steps(3, 0.0).last().expect("samples");
    let wires = host.bench.act(|_, site| (site.train.count(Encoder::Motor), site.train.count(Encoder::Load)));
    assert!(wires.0 > 8_000 && wires.1 > 2_500, "{wires:?}");
    assert_eq!((i64::from(sample.motor_counts.get()), i64::from(sample.load_counts.get())), wires);
}

#[test]
fn the_fault_line_of_an_odrive_refuses_to_arm_and_stops_a_run_within_a_period() {
    let mut host = idle();
    // Bits of the gate driver's status, with the detail of its fault.
    for (status, detail) in [(0, 2), (1 << 8, 3), (1 << 9, 3), (1 << 5, 4), (1, 4), (1 << 7, 5), (1 << 6, 5)]
    {
        set_fault(&mut host, Some(status));
        host.bench.advance(Duration::from_millis(6));
        assert_eq!(host.refusal_to_arm(), (Outcome::PowerStageFault, detail), "{status:#x}");
        set_fault(&mut host, None);
        host.bench.advance(Duration::from_millis(6));
        host.run_under_torque();
        let instant = host.bench.now();
        set_fault(&mut host, Some(status));
        host.steps(3, 1.0);
        let off = host.bench.time_to_off(instant).expect("the bridge off");
        assert!(off <= Duration::from_millis(1), "{off:?}");
        let [fault] = host.faults()[..] else { panic!("one fault") };
        assert_eq!((fault.code, fault.detail), (FaultCode::PowerStage, detail), "{status:#x}");
        set_fault(&mut host, None);
        assert_eq!(host.command(ClearFault {}), (Outcome::Accepted, State::Idle));
    }
}

/// Pulls the fault line with this status of the gate driver, or releases it.
fn set_fault(host: &mut Host, status: Option<u16>) {
    host.bench.act(move |chip, _| {
        chip.gate_driver().expect("a gate driver").set_status(status.unwrap_or(0));
        chip.drive_fault_line(status.is_none());
    });
}

#[test]
fn a_supply_that_comes_late_or_goes_leaves_no_gate_driver_without_its_limit() {
    let mut host = idle();
    let set_supply = |host: &mut Host, has_supply| {
        host.bench.act(move |chip, _| chip.gate_driver().expect("a gate driver").set_supply(has_supply));
        host.bench.advance(Duration::from_millis(6));
    };
    for _ in 0..2 {
        set_supply(&mut host, false);
        assert_eq!(host.refusal_to_arm(), (Outcome::PowerStageFault, 3));
        set_supply(&mut host, true);
        // 0.73 V, latched.
        let control = host.bench.act(|chip, _| chip.gate_driver().expect("a gate driver").control());
        assert_eq!(control, 21 << 6 | 1 << 4);
        host.run();
        assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
    }
}

#[test]
fn every_board_with_a_break_input_counts_drives_and_stops_at_its_own_pins() {
    let has_break_input =
        |name: &str| boards::open(name).is_ok_and(|wiring| wiring.bridge.break_input.is_some());
    let names: Vec<_> = BUILT_IN.iter().map(|(name, _)| name).filter(|name| has_break_input(name)).collect();
    assert!(names.len() >= 4, "{names:?}");
    of_each(&names, |name| counts_drives_and_stops(name));
}

fn counts_drives_and_stops(board: &str) {
    let mut host = Host::under_torque(&image_of(board), Duration::from_millis(1));
    assert_eq!(host.bench.act(|chip, _| chip.misconfigured()), [""; 0], "{board}");
    host.bench.turn(9e3, 3e3);
    host.steps(100, 0.0);
    host.bench.turn(0.0, 0.0);
    let sample = *host.steps(3, 0.0).last().expect("samples");
    let wires = host.bench.act(|_, site| (site.train.count(Encoder::Motor), site.train.count(Encoder::Load)));
    assert!(wires.0 > 800 && wires.1 > 250, "{board}: {wires:?}");
    let counted = (i64::from(sample.motor_counts.get()), i64::from(sample.load_counts.get()));
    assert_eq!(counted, wires, "{board}");
    // Not ready, or its wire cut.
    for level in [Some(true), None] {
        let instant = host.bench.now();
        host.bench.act(move |chip, _| chip.drive_break(level));
        host.steps(3, 1.0);
        let off = host.bench.time_to_off(instant).expect("the bridge off");
        assert!(off <= Duration::from_micros(1), "{board}: {off:?}");
        assert!(!host.bench.bridge().is_enabled, "{board}: the enable line is low");
        let [fault] = host.faults()[..] else { panic!("{board}: one fault") };
        assert_eq!((fault.code, fault.detail), (FaultCode::PowerStage, 1), "{board}");
        host.bench.act(|chip, _| chip.drive_break(Some(false)));
        host.steps(3, 1.0);
        assert_eq!(host.command(ClearFault {}), (Outcome::Accepted, State::Idle));
        host.run_under_torque();
    }
    assert_eq!(host.shake_hands(SESSION).board.as_str(), board);
    let period = host.bench.act(|chip, _| chip.modulation_period());
    assert_eq!(period, Some(Duration::from_micros(50)), "{board}");
    assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
    // An update would turn on again what software alone may.
    host.bench.advance(Duration::from_millis(1));
    let (bridge, levels) = host.bench.act(|chip, _| (chip.bridge(), chip.output_levels()));
    assert!(!bridge.has_main_output && !bridge.has_active_gate, "{board}: {bridge:?}");
    assert_eq!(levels, (Some(false), false), "{board}: driven low, not open");
}
