//! Faults of bench mode: each turns the power stage off within a period.

use std::time::Duration;

use lashloop_firmware::power_stage::PowerStageFault;
use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::{ClearFault, EmergencyStop, GetParameter, Reference};

use crate::pin_host::{PERIOD, PinHost};

/// Counts of the default encoders for a turn of the load at 3 turns of the motor.
const TURN: i64 = 131_072;

#[test]
fn a_host_without_references_trips_the_watchdog_within_a_period() {
    let mut host = PinHost::under_torque();
    let last_reference = Duration::from_millis(1);
    let mut answers = Vec::new();
    while host.drive.state() == State::Running {
        assert!(host.stage_nm().is_some());
        assert!(host.due < Duration::from_millis(100), "no watchdog");
        answers = host.tick();
    }
    let off_after = host.due - PERIOD - last_reference;
    assert!(off_after <= Duration::from_millis(20) + PERIOD, "{off_after:?}");
    let report = host.assert_faulted(&answers, FaultCode::Watchdog);
    assert_eq!(report.limit, 0.02);
}

#[test]
fn references_alone_feed_the_watchdog() {
    let mut host = PinHost::running(&[]);
    for _ in 0..100 {
        host.refer(0.1);
        host.step();
    }
    assert_eq!(host.drive.state(), State::Running);
}

#[test]
fn a_late_reference_is_refused_and_reveals_the_watchdog() {
    let mut host = PinHost::under_torque();
    host.clock.advance(Duration::from_millis(21));
    let answers = host.send(Reference { number: 2, reference_rad: 0.0 });
    assert!(
        matches!(answers[0], DriveMessage::CommandResult(it) if it.outcome == Outcome::WrongState),
        "{answers:?}"
    );
    host.assert_faulted(&answers, FaultCode::Watchdog);
}

#[test]
fn a_fault_of_the_power_stage_is_latched_with_its_line() {
    for (fault, detail) in [(PowerStageFault::BreakInput, 1), (PowerStageFault::FaultLine, 2)] {
        let mut host = PinHost::under_torque();
        host.readings.stage_fault = Some(fault);
        let answers = host.tick();
        let report = host.assert_faulted(&answers, FaultCode::PowerStage);
        assert_eq!((report.detail, report.sequence), (detail, 0));
        // The line is clear again, and the fault stays.
        host.readings.stage_fault = None;
        host.tick();
        assert_eq!(host.stage_nm(), None);
        assert_eq!(host.command(ClearFault {}), (Outcome::Accepted, State::Idle));
        assert_eq!(host.stage_nm(), None, "clearing does not arm");
    }
}

#[test]
fn a_fault_of_the_stage_counts_before_the_first_reference_too() {
    let mut host = PinHost::running(&[]);
    host.readings.stage_fault = Some(PowerStageFault::FaultLine);
    let answers = host.tick();
    host.assert_faulted(&answers, FaultCode::PowerStage);
}

#[test]
fn illegal_transitions_lose_the_encoder() {
    for (code, lose) in [
        (
            FaultCode::MotorEncoderLost,
            (|host, times| host.readings.motor.illegal_transitions += times) as fn(&mut PinHost, u32),
        ),
        (FaultCode::LoadEncoderLost, |host, times| host.readings.load.illegal_transitions += times),
    ] {
        // The first one of a run counts.
        for times in [1, 2] {
            let mut host = PinHost::under_torque();
            lose(&mut host, times);
            let answers = host.tick();
            assert_eq!(host.assert_faulted(&answers, code).detail, times);
        }
        // Before the first step too.
        let mut host = PinHost::running(&[]);
        lose(&mut host, 1);
        let answers = host.tick();
        assert_eq!(host.assert_faulted(&answers, code).detail, 1);
    }
}

#[test]
fn an_encoder_that_stands_still_while_the_other_moves_is_lost() {
    for (code, motor, load) in [
        (FaultCode::LoadEncoderLost, 3 * TURN / 100, 0),
        (FaultCode::MotorEncoderLost, 0, TURN / 100),
        // One channel of the motor encoder still counts up and down.
        (FaultCode::MotorEncoderLost, -1, TURN / 100),
    ] {
        for start in [0, TWISTED] {
            assert_lost(start, (code, motor, load));
        }
    }
}

/// Counts of the motor for a twist of 1 rad.
const TWISTED: i64 = 20_861;

/// Requires the loss of the encoder that stands still, in a run that starts at a twist.
fn assert_lost(start: i64, (code, motor, load): (FaultCode, i64, i64)) {
    let mut host = PinHost::running(&[("twist_limit_rad", ParameterValue::F32(0.5))]);
    host.refer(0.0);
    let (mut at, mut answers) = ((start, 0), Vec::new());
    // Both move far, then one of them stands still on the way back.
    for k in 0..300 {
        at = (at.0 + 3 * TURN / 100, at.1 + TURN / 100);
        host.turn(at.0, at.1);
        host.refer(0.0);
        assert_eq!(host.step().status.state, State::Running, "step {k}");
    }
    for k in 0..300 {
        let stuck = motor == -1;
        at = (at.0 - if stuck { if k % 2 == 0 { 1 } else { -1 } } else { motor }, at.1 - load);
        host.turn(at.0, at.1);
        host.refer(0.0);
        answers = host.tick();
        if host.drive.state() == State::Faulted {
            break;
        }
    }
    let report = host.assert_faulted(&answers, code);
    assert_eq!(report.limit, 0.5);
    // A hundredth of a turn of the load is 0.19 rad at the motor.
    assert!((0.5..0.7).contains(&report.value), "{code}: {} rad", report.value);
    let [DriveMessage::BenchSample(sample), _] = answers[..] else { panic!("{answers:?}") };
    assert_eq!((sample.torque_nm, sample.status.state), (0.0, State::Faulted));
}

#[test]
fn a_motor_against_its_torque_is_a_fault_if_the_mechanics_rested_before_the_run() {
    for (rest_ms, is_fault) in [(0, false), (499, false), (501, true)] {
        for (motor, load) in [(100, 0), (0, 100)] {
            let mut host = PinHost::with(&[("twist_limit_rad", ParameterValue::F32(100.0))]);
            host.turn(motor, load);
            for tick in 0..=rest_ms {
                // Counts of an encoder at rest may alternate.
                host.turn(motor + tick % 2, load);
                host.tick();
            }
            assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
            assert_eq!(host.start(), (Outcome::Accepted, State::Running));
            let mut answers = Vec::new();
            for step in 0..100 {
                host.refer(1.0);
                host.turn(motor - 10 * step * step, load);
                answers = host.tick();
                if host.drive.state() == State::Faulted {
                    break;
                }
            }
            if is_fault {
                let report = host.assert_faulted(&answers, FaultCode::MotorAgainstTorque);
                assert_eq!((report.limit, report.detail), (1.0, 0));
            } else {
                assert_eq!(host.drive.state(), State::Running, "{rest_ms} ms of rest");
            }
        }
    }
}

#[test]
fn a_jump_of_an_encoder_is_the_fault_of_hil_mode() {
    for (code, motor, load) in
        [(FaultCode::MotorEncoderJump, 25_000, 0), (FaultCode::LoadEncoderJump, 0, 2_500)]
    {
        let mut host = PinHost::under_torque();
        host.turn(motor, load);
        let answers = host.tick();
        let report = host.assert_faulted(&answers, code);
        assert_eq!(report.sequence, 1, "the step at fault is the last one");
    }
}

#[test]
fn a_reference_that_is_not_finite_is_a_fault_at_the_next_step() {
    let mut host = PinHost::under_torque();
    host.refer(f32::NAN);
    let answers = host.tick();
    host.assert_faulted(&answers, FaultCode::ReferenceNotFinite);
}

#[test]
fn a_step_that_ends_after_its_period_is_a_fault() {
    let mut host = PinHost::under_torque();
    let answers = host.tick_after(PERIOD);
    assert_eq!(answers.len(), 1, "the period itself is in time: {answers:?}");
    assert_eq!(host.drive.state(), State::Running);
    host.refer(1.0);
    let answers = host.tick_after(PERIOD + Duration::from_micros(1));
    let report = host.assert_faulted(&answers, FaultCode::TickOverrun);
    assert_eq!((report.value, report.limit), (0.001_001, 0.001));
}

#[test]
fn a_missing_tick_is_a_fault_at_the_next_one() {
    let mut host = PinHost::under_torque();
    host.due += PERIOD;
    let answers = host.tick();
    let report = host.assert_faulted(&answers, FaultCode::TickOverrun);
    assert_eq!((report.value, report.limit), (0.002, 0.0015));
}

#[test]
fn ticks_that_stop_are_a_fault_of_the_clock() {
    let mut host = PinHost::under_torque();
    host.clock.advance(PERIOD * 3 / 2);
    host.drive.tick(lashloop_firmware::drive::Clock::now(&host.clock));
    assert_eq!(host.take_output(), []);
    host.clock.advance(Duration::from_nanos(1));
    host.drive.tick(lashloop_firmware::drive::Clock::now(&host.clock));
    let answers = host.take_output();
    host.assert_faulted(&answers, FaultCode::TickOverrun);
}

#[test]
fn a_monitor_of_the_tick_latches_a_fault_in_running_alone() {
    let overdue = PERIOD * 3 / 2;
    let mut host = PinHost::under_torque();
    host.clock.advance(overdue);
    host.drive.miss_tick(lashloop_firmware::drive::Clock::now(&host.clock));
    assert_eq!(host.stage_nm(), None, "off before the report is encoded");
    assert!(host.drive.has_output());
    let answers = host.take_output();
    let report = host.assert_faulted(&answers, FaultCode::TickOverrun);
    assert_eq!((report.value, report.limit), (0.0015, 0.0015));
    assert!(!host.drive.has_output());
    for mut host in [PinHost::idle(), PinHost::with(&[])] {
        host.drive.miss_tick(overdue);
        assert_eq!((host.take_output(), host.drive.state()), (vec![], State::Idle));
    }
}

#[test]
fn the_report_of_a_fault_goes_ahead_of_the_next_answer() {
    let mut host = PinHost::under_torque();
    host.clock.advance(PERIOD * 2);
    host.drive.tick(lashloop_firmware::drive::Clock::now(&host.clock));
    let answers = host.send(ClearFault {});
    let [DriveMessage::FaultReport(_), DriveMessage::CommandResult(result)] = answers[..] else {
        panic!("{answers:?}")
    };
    assert_eq!((result.outcome, result.state), (Outcome::Accepted, State::Idle));
}

#[test]
fn the_report_of_a_fault_is_not_earlier_than_the_answer_before_it() {
    let mut host = PinHost::under_torque();
    let late = Duration::from_micros(300);
    let now = host.due + late;
    host.clock.set(now);
    host.send(GetParameter { index: 0 });
    // The step was due before the request arrived.
    host.readings.stage_fault = Some(PowerStageFault::FaultLine);
    let answers = host.tick_after(late);
    let report = host.assert_faulted(&answers, FaultCode::PowerStage);
    assert_eq!(report.device_time_us, Some(now.as_micros() as u32));
}

#[test]
fn an_emergency_stop_turns_the_stage_off_at_once() {
    let mut host = PinHost::under_torque();
    host.send(EmergencyStop {});
    assert_eq!((host.stage_nm(), host.drive.state()), (None, State::Faulted));
}

#[test]
fn reports_that_nobody_takes_displace_no_fault() {
    let mut host = PinHost::running(&[("watchdog_us", ParameterValue::U32(1_000_000))]);
    host.refer(1.0);
    for _ in 0..100 {
        host.clock.set(host.due);
        host.drive.sample(&host.readings, host.due, &host.clock);
        host.due += PERIOD;
    }
    host.readings.stage_fault = Some(PowerStageFault::FaultLine);
    let answers = host.tick();
    assert!(answers.len() < 100, "more reports than the buffer holds: {}", answers.len());
    host.assert_faulted(&answers, FaultCode::PowerStage);
}
