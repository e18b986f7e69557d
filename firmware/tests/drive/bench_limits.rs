//! Limits of bench mode that hold without a host, the inputs, and the zero of the encoders.

use std::f32::consts::TAU;

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_plant::random::{Pcg64Mcg, SeedableRng, uniform};
use lashloop_protocol::DriveMessage;
use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State, ZeroSource};
use lashloop_protocol::message::{ClearFault, FaultReport, SetZero, Stop};

use crate::pin_host::{PinHost, index};

/// Counts of a turn of either encoder.
const TURN: f32 = 131_072.0;

fn number(value: f32) -> ParameterValue {
    ParameterValue::F32(value)
}

/// The law whose reference is a torque.
fn open_loop() -> (&'static str, ParameterValue) {
    let law = Laws::NAMES.iter().position(|name| *name == "open-loop").expect("a law of the drive");
    ("controller", ParameterValue::U32(law as u32))
}

/// A drive that runs at the torque of its reference, limited to 100 N m.
fn by_torque(parameters: &[(&str, ParameterValue)]) -> PinHost {
    PinHost::running(&[&[open_loop()][..], parameters].concat())
}

/// Steps with this torque, and this motion of the load before each, until a fault; the report and the number of steps.
fn until_fault(host: &mut PinHost, torque_nm: f32, load_rad: f32) -> (FaultReport, usize) {
    let mut load = 0.0;
    for steps in 1..3000 {
        load += load_rad * TURN / TAU;
        host.turn((3.0 * load) as i64, load as i64);
        host.refer(torque_nm);
        let answers = host.tick();
        if let Some(DriveMessage::FaultReport(report)) = answers.last() {
            return (host.assert_faulted(&answers, report.code), steps);
        }
    }
    panic!("no fault");
}

#[test]
fn the_bridge_is_off_in_the_step_in_which_motor_or_load_leaves_its_travel() {
    for (name, code, limit, per_step) in [
        ("load_travel_max_rad", FaultCode::LoadTravel, 0.5, 0.02),
        ("load_travel_min_rad", FaultCode::LoadTravel, -0.5, -0.02),
        ("motor_travel_max_rad", FaultCode::MotorTravel, 1.5, 0.02),
        ("motor_travel_min_rad", FaultCode::MotorTravel, -1.5, -0.02),
    ] {
        let mut host = by_torque(&[(name, number(limit))]);
        let (report, steps) = until_fault(&mut host, 1.0_f32.copysign(limit), per_step);
        assert_eq!((report.code, report.limit), (code, limit));
        assert_eq!(steps, 26, "{name}: at {} rad", report.value);
    }
}

#[test]
fn a_travel_without_a_position_is_refused_by_name() {
    for (min, max) in
        [("load_travel_min_rad", "load_travel_max_rad"), ("motor_travel_min_rad", "motor_travel_max_rad")]
    {
        let mut host = PinHost::with(&[(min, number(1.0)), (max, number(0.5))]);
        assert_eq!(host.arm(), (Outcome::Inconsistent, State::Idle), "{min}");
        host.set(max, number(1.0));
        assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
    }
}

#[test]
fn a_motor_that_stands_still_at_the_torque_limit_for_the_time_of_a_stall_is_stopped() {
    let (report, steps) = until_fault(&mut by_torque(&[("stall_time_s", number(0.2))]), 95.0, 0.0);
    assert_eq!((report.code, report.limit), (FaultCode::Stall, 0.2));
    // The torque of the first step holds from the second on.
    assert!((201..=203).contains(&steps), "{steps}");
    // Both encoders lost: by default within a second.
    let (report, steps) = until_fault(&mut by_torque(&[]), 100.0, 0.0);
    assert_eq!(report.code, FaultCode::Stall);
    assert!(steps < 1000, "{steps}");
}

#[test]
fn a_motor_that_moves_or_has_less_torque_does_not_stall() {
    // Counts of motor and load in every n-th step: both, one of both, and a motion just before the end of the time.
    for (torque_nm, motor, load, every) in
        [(100.0, 15, 5, 1), (100.0, 5, 0, 1), (100.0, 0, 5, 1), (100.0, 15, 5, 45), (85.0, 0, 0, 1)]
    {
        let mut host = by_torque(&[("stall_time_s", number(0.05))]);
        for step in 0..500 {
            let motions = step / every;
            host.turn(motions * motor, motions * load);
            host.refer(torque_nm);
            let state = host.step().status.state;
            assert_eq!(
                state,
                State::Running,
                "{torque_nm} N m, {motor} and {load} counts each {every} steps"
            );
        }
    }
}

#[test]
fn a_torque_above_the_continuous_one_ends_when_the_winding_is_as_hot_as_it_makes_it() {
    let limits = [("torque_continuous_nm", number(20.0)), ("motor_thermal_s", number(0.3))];
    let (report, steps) = until_fault(&mut by_torque(&limits), 40.0, 1e-3);
    assert_eq!((report.code, report.detail, report.limit), (FaultCode::Overload, 1, 20.0));
    // 1 - exp(-t/0.3 s) = (20/40)^2.
    let expected_s = -0.3 * 0.75_f32.ln();
    assert!((steps as f32 * 1e-3 - expected_s).abs() < 0.003, "{steps} steps, {expected_s} s");
    // Forever at the continuous torque.
    let mut host = by_torque(&limits);
    for _ in 0..3000 {
        host.refer(20.0);
        assert_eq!(host.step().status.state, State::Running);
    }
}

#[test]
fn a_measured_torque_below_half_the_command_is_missing() {
    let run = |measured_nm: f32, command_nm: f32| {
        let mut host = by_torque(&[("missing_torque_time_s", number(0.1))]);
        host.readings.torque_nm = Some(measured_nm);
        for steps in 1..500 {
            host.turn(steps * 100, steps * 33);
            host.refer(command_nm);
            if let Some(DriveMessage::FaultReport(report)) = host.tick().last() {
                assert_eq!(report.code, FaultCode::TorqueMissing);
                return Some(steps);
            }
        }
        None
    };
    for (measured_nm, command_nm) in [(0.0, 50.0), (24.0, 50.0), (-50.0, 50.0), (0.0, -50.0), (50.0, -50.0)] {
        let steps = run(measured_nm, command_nm).expect("a fault");
        assert!((101..=103).contains(&steps), "{measured_nm} of {command_nm} N m: {steps}");
    }
    for (measured_nm, command_nm) in [(26.0, 50.0), (-26.0, -50.0), (0.0, 9.0)] {
        assert_eq!(run(measured_nm, command_nm), None, "{measured_nm} of {command_nm} N m");
    }
}

#[test]
fn a_torque_towards_an_active_limit_switch_ends_the_run_and_one_away_from_it_does_not() {
    for (name, detail, towards_nm) in [("negative_limit_input", 1, -5.0), ("positive_limit_input", 2, 5.0)] {
        // A broken wire of a contact that opens is active.
        let mut host = by_torque(&[(name, ParameterValue::U32(2))]);
        host.refer(-towards_nm);
        assert_eq!(host.step().status.state, State::Running);
        host.refer(towards_nm);
        let answers = host.tick();
        assert_eq!(host.assert_faulted(&answers, FaultCode::LimitSwitch).detail, detail);
        let mut host = by_torque(&[(name, ParameterValue::U32(1))]);
        host.refer(towards_nm);
        assert_eq!(host.step().status.state, State::Running, "an open contact that closes");
    }
}

#[test]
fn a_drive_without_its_enable_neither_arms_nor_runs() {
    // Active while closed, and while open.
    for (input, is_active) in [(1, true), (2, false)] {
        let mut host = PinHost::with(&[("enable_input", ParameterValue::U32(input))]);
        host.readings.contacts.enable = !is_active;
        host.tick();
        assert_eq!(host.arm(), (Outcome::PowerStageFault, State::Idle));
        host.readings.contacts.enable = is_active;
        host.tick();
        assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
        assert_eq!(host.start(), (Outcome::Accepted, State::Running));
        host.refer(0.0);
        host.step();
        host.readings.contacts.enable = !is_active;
        let answers = host.tick();
        assert_eq!(host.assert_faulted(&answers, FaultCode::PowerStage).detail, 8);
    }
}

#[test]
fn the_torque_changes_no_faster_than_its_slew() {
    let mut host = by_torque(&[("torque_slew_nm_s", number(2000.0))]);
    let mut torques = Vec::new();
    for reference_nm in [5.0, 5.0, 5.0, 5.0, -5.0, -5.0] {
        host.refer(reference_nm);
        torques.push(host.step().torque_nm);
    }
    assert_eq!(torques, [2.0, 4.0, 5.0, 5.0, 3.0, 1.0]);
}

#[test]
fn the_zero_of_both_encoders_is_where_the_host_or_the_home_switch_says() {
    let mut host = PinHost::with(&[("home_input", ParameterValue::U32(1))]);
    let counts = |host: &mut PinHost| {
        host.arm();
        host.start();
        host.refer(0.0);
        let sample = host.step();
        assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
        (sample.motor_counts.get(), sample.load_counts.get())
    };
    host.turn(700, -40);
    host.tick();
    assert_eq!(host.command(SetZero { source: ZeroSource::Present }), (Outcome::Accepted, State::Idle));
    host.turn(703, -41);
    host.tick();
    assert_eq!(counts(&mut host), (3, -1));
    // A switch that is closed at the request has to open first.
    host.readings.contacts.home = true;
    assert_eq!(host.command(SetZero { source: ZeroSource::Home }), (Outcome::Accepted, State::Idle));
    for (home, motor) in [(true, 800), (false, 900), (true, 1000), (true, 1100), (false, 1200), (true, 1300)]
    {
        host.readings.contacts.home = home;
        host.turn(motor, motor / 10);
        host.tick();
    }
    assert_eq!(counts(&mut host), (300, 30));
    host.reset();
    assert_eq!(counts(&mut host), (300, 30), "after a reset");
}

#[test]
fn the_zero_of_an_encoder_is_at_its_index_pulse_and_that_of_the_other_where_it_then_is() {
    let zero = |host: &mut PinHost| {
        host.arm();
        host.start();
        host.refer(0.0);
        let sample = host.step();
        assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
        let of = |at: EncoderCounts, counts: EncoderCounts| at.get() - counts.get();
        (
            of(host.readings.motor.counts, sample.motor_counts),
            of(host.readings.load.counts, sample.load_counts),
        )
    };
    for (home_input, at_pulse, want) in [(0, false, (340, 36)), (1, true, (340, 36)), (1, false, (0, 0))] {
        let mut host = PinHost::with(&[
            ("index_input", ParameterValue::U32(1)),
            ("home_input", ParameterValue::U32(home_input)),
        ]);
        assert_eq!(host.command(SetZero { source: ZeroSource::Home }), (Outcome::Accepted, State::Idle));
        // The pulse of the first readings may be older than the request; those after the first one move nothing.
        for (motor, index) in [(100, Some(90)), (200, None), (360, Some(340)), (500, Some(480))] {
            host.readings.contacts.home = at_pulse && motor == 360;
            host.turn(motor, motor / 10);
            host.tick();
            if let Some(side) = host.drive.awaited_index() {
                assert_eq!(side, 0);
                host.drive.note_index(side, index.map(EncoderCounts::wrapping));
            }
        }
        assert_eq!(zero(&mut host), want, "{home_input} {at_pulse}");
    }
}

#[test]
fn a_zero_is_refused_outside_idle_and_without_a_home_switch() {
    let mut host = PinHost::with(&[("index_input", ParameterValue::U32(2))]);
    let load = host.refusal(SetZero { source: ZeroSource::Home });
    assert_eq!(load, (Outcome::Inconsistent, index("index_input").into(), State::Idle), "no such input");
    let mut host = PinHost::with(&[]);
    let home = host.refusal(SetZero { source: ZeroSource::Home });
    assert_eq!(home, (Outcome::Inconsistent, index("home_input").into(), State::Idle));
    host.arm();
    assert_eq!(host.command(SetZero { source: ZeroSource::Present }), (Outcome::WrongState, State::Armed));
    assert_eq!(
        PinHost::unread().command(SetZero { source: ZeroSource::Present }).0,
        Outcome::EncoderImplausible
    );
}

#[test]
fn in_a_million_steps_of_anything_no_torque_is_too_fast_and_none_is_outside_running() {
    const SLEW_NM: f32 = 3.0;
    let mut random = Pcg64Mcg::seed_from_u64(0x1a54_100b);
    let mut host = PinHost::with(&[
        open_loop(),
        ("torque_slew_nm_s", number(1e3 * SLEW_NM)),
        ("bench_sample_every", ParameterValue::U32(1000)),
        ("positive_limit_input", ParameterValue::U32(1)),
        ("enable_input", ParameterValue::U32(2)),
    ]);
    let (mut last_nm, mut runs, mut faults, mut slowed) = (0.0, 0, 0, 0_u32);
    let (mut motor, mut reference_nm) = (0.0, 0.0);
    for _ in 0..1_000_000 {
        let dice = uniform(&mut random);
        match host.drive.state() {
            State::Running if dice < 0.5 => {
                reference_nm =
                    if dice < 0.1 { (300.0 * uniform(&mut random) - 150.0) as f32 } else { reference_nm };
                host.refer(reference_nm);
            }
            State::Running if dice < 0.5001 => {
                host.command(Stop {});
            }
            State::Running if dice < 0.5002 => host.refer(f32::NAN),
            State::Faulted => {
                faults += 1;
                host.command(ClearFault {});
            }
            State::Idle => {
                host.arm();
            }
            State::Armed => {
                runs += u32::from(host.start().0 == Outcome::Accepted);
                last_nm = 0.0;
            }
            _ => {}
        }
        let before = host.drive.state();
        motor += 400.0 * uniform(&mut random) - 200.0;
        host.turn(motor as i64, (motor / 3.0) as i64);
        host.readings.contacts.positive_limit = uniform(&mut random) < 1e-3;
        host.readings.contacts.enable = uniform(&mut random) < 1e-4;
        host.tick();
        match host.stage_nm() {
            None => assert_ne!(host.drive.state(), State::Running),
            Some(torque_nm) => {
                assert_eq!((before, host.drive.state()), (State::Running, State::Running));
                let change_nm = (torque_nm - last_nm).abs();
                assert!(change_nm <= SLEW_NM * 1.0001, "from {last_nm} to {torque_nm} N m");
                assert!(torque_nm.abs() <= 100.0);
                slowed += u32::from(change_nm > 0.99 * SLEW_NM);
                last_nm = torque_nm;
            }
        }
    }
    assert!(runs > 100 && faults > 100 && slowed > 10_000, "{runs} runs, {faults} faults, {slowed} slowed");
}
