//! Causes that end a run by the current loop.

use std::time::Duration;

use lashloop_plant::electrical::{ElectricalParameters, ReverseCurrent};
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue};
use lashloop_silicon::symbols::Symbols;

use super::{BY_CURRENT, COMPLEMENTARY, change, current_a, idle, motor, powered_up, settings, torques};
use crate::bench::image;
use crate::host::{BENCH, Host};

/// Voltage of the bus, V.
fn bus_v(host: &mut Host) -> f64 {
    host.bench.act(|_, site| site.train.motor_at_bridge().expect("a motor").circuit().bus_v())
}

/// The only fault, of the power stage: its detail.
fn stage_fault(host: &mut Host) -> u32 {
    let faults = host.faults();
    let [fault] = faults[..] else { panic!("one fault, not {faults:?}") };
    assert_eq!(fault.code, FaultCode::PowerStage);
    fault.detail
}

/// Time from an instant to the bridge off, at most this.
fn off_within(host: &mut Host, instant: Duration, limit: Duration) -> Duration {
    let off = host.bench.time_to_off(instant).expect("the bridge off");
    assert!(off <= limit, "{off:?}");
    off
}

#[test]
fn a_sensor_that_is_off_by_a_quarter_of_its_range_arms_nothing() {
    let motor = ElectricalParameters { sense_offset_a: 25.0, ..motor() };
    let mut host = idle(&image(), motor);
    assert_eq!(host.refusal_to_arm(), (Outcome::PowerStageFault, 6));
}

/// A shaft that is turned faster than the whole voltage could hold.
pub fn overcurrent(image: &Symbols) -> Duration {
    let mut host = idle(image, motor());
    host.run();
    host.steps(5, 1.0);
    // 240 V against 48.
    host.bench.turn(-1e3, 0.0);
    host.refer(1.0);
    let instant = (0..2_000).find_map(|_| {
        host.bench.advance(Duration::from_micros(1));
        // The motor is followed twice in a period.
        (current_a(&mut host).abs() > 75.0).then(|| host.bench.now() - Duration::from_micros(26))
    });
    let instant = instant.expect("1.5 times the largest current");
    host.steps(2, 1.0);
    // A sample comes once in a period, and its interrupt takes some us to judge it.
    let off = off_within(&mut host, instant, Duration::from_micros(56));
    assert_eq!(stage_fault(&mut host), 4);
    host.bench.turn(0.0, 0.0);
    host.bench.advance(Duration::from_millis(5));
    assert_eq!(current_a(&mut host), 0.0);
    off
}

/// A sensor whose wire is open, or whose direction is the other one, at a voltage at which the current stays below 1.5 times its limit
/// and at twice that. Returns the longest time from the command on.
pub fn wrong_sensor(image: &Symbols) -> Duration {
    let cases = [(24.0, false), (24.0, true), (48.0, false), (48.0, true)];
    let off = cases.map(|(supply_v, is_reversed)| {
        let motor = ElectricalParameters { supply_v, ..motor() };
        let mut host = idle(image, motor);
        if is_reversed {
            assert_eq!(host.set("current_direction", ParameterValue::U32(1)), Outcome::Accepted);
        }
        host.run();
        host.steps(3, 0.0);
        if !is_reversed {
            // Such a range shows the middle for every current.
            change(&mut host, |motor| motor.sense_range_a = 1e4);
        }
        let instant = host.refer(1.0);
        let torques = torques(&mut host, &motor, Duration::from_millis(4));
        let off = off_within(&mut host, instant, Duration::from_millis(3));
        let most_a = torques.iter().fold(0.0_f64, |most, nm| most.max(nm.abs() / 0.24));
        println!(
            "{supply_v} V, reversed {is_reversed}: off {off:?} after the command, at most {most_a:.0} A"
        );
        assert!(most_a < 75.0 + 5.0, "{most_a} A");
        assert_eq!(stage_fault(&mut host), 6);
        off
    });
    off.into_iter().max().expect("cases")
}

/// A bus without voltage arms nothing, and a weak one ends the run.
pub fn undervoltage(image: &Symbols) -> Duration {
    let motor = motor();
    let mut host = idle(image, motor);
    let nominal_v = motor.supply_v;
    // Below a 64th of the range nothing is connected.
    change(&mut host, |motor| motor.supply_v = 0.0);
    host.bench.advance(Duration::from_millis(50));
    assert_eq!(host.refusal_to_arm(), (Outcome::PowerStageFault, 3));
    change(&mut host, move |motor| motor.supply_v = nominal_v);
    host.bench.advance(Duration::from_millis(50));
    host.run();
    host.steps(5, 1.0);
    // A fifth of the 24 V by default are 4.8 V.
    change(&mut host, |motor| motor.supply_v = 4.0);
    let under = (0..20_000).find(|_| {
        host.bench.advance(Duration::from_micros(1));
        bus_v(&mut host) < 4.75
    });
    let instant = host.bench.now();
    assert!(under.is_some());
    host.steps(2, 1.0);
    // The bus is followed twice in a period.
    let off = off_within(&mut host, instant, Duration::from_micros(56));
    assert_eq!(stage_fault(&mut host), 3);
    off
}

/// The shaft turns against the torque: 24 V times 21 A go back, minus the losses, into a bus of 1 mF.
pub fn overvoltage(image: &Symbols) -> Duration {
    let motor = ElectricalParameters { reverse_current: ReverseCurrent::Blocked, ..motor() };
    let mut host = idle(image, motor);
    assert_eq!(host.set("supply_max_v", ParameterValue::F32(55.0)), Outcome::Accepted);
    host.run();
    host.steps(5, 1.0);
    host.bench.turn(-100.0, 0.0);
    host.refer(1.0);
    let (mut over, mut most_v) = (None, 0.0_f64);
    for _ in 0..10_000 {
        host.bench.advance(Duration::from_micros(1));
        let now_v = bus_v(&mut host);
        most_v = most_v.max(now_v);
        // A code of the converter is 15 mV.
        if over.is_none() && now_v > 55.02 {
            over = Some(host.bench.now());
        }
    }
    let off = off_within(&mut host, over.expect("an overvoltage"), Duration::from_micros(56));
    println!("off {off:?} after 55 V, at most {most_v:.1} V");
    // The current decays in 0.3 ms: 3 mC into the 1 mF of the bus.
    assert!(most_v < 59.0, "{most_v} V");
    assert_eq!(stage_fault(&mut host), 7);
    off
}

/// The first mean of the sensor at rest takes 1,024 periods.
#[test]
fn a_drive_without_the_offset_of_its_sensor_does_not_arm() {
    // The names of the parameters are known from then on.
    idle(&image(), motor());
    let mut host = powered_up(&image(), motor());
    let needed = [
        ("torque_source", ParameterValue::U32(BY_CURRENT)),
        ("stage_mode", ParameterValue::U32(COMPLEMENTARY)),
        ("torque_limit_nm", ParameterValue::F32(0.4)),
    ];
    for (name, value) in BENCH.iter().chain(&needed) {
        assert_eq!(host.set(name, *value), Outcome::Accepted, "{name}");
    }
    host.bench.advance_to(Duration::from_millis(30));
    host.bench.advance(host.period);
    let refusal = host.refusal_to_arm();
    println!("refused {:?} after power-up", host.bench.now());
    assert!(host.bench.now() < Duration::from_millis(45));
    assert_eq!(refusal, (Outcome::PowerStageFault, 6));
    host.set_all(&settings(&motor()));
    host.bench.advance_to(Duration::from_millis(75));
    host.run();
}

/// Without samples the bridge would keep its last duty, and no current would be too large.
pub fn stopped_converters(image: &Symbols) -> Duration {
    let mut host = idle(image, motor());
    host.run();
    host.steps(5, 1.0);
    let instant = host.bench.act(|chip, _| {
        chip.stop_converters();
        chip.now()
    });
    host.steps(5, 1.0);
    let off = off_within(&mut host, instant, Duration::from_millis(3));
    assert_eq!(stage_fault(&mut host), 6);
    off
}

/// A supply that is too weak for half the torque, and not for the loop's own limits.
pub fn missing_torque(image: &Symbols) -> Duration {
    let motor = ElectricalParameters { reverse_current: ReverseCurrent::Blocked, ..motor() };
    let mut host = idle(image, motor);
    assert_eq!(host.set("missing_torque_time_s", ParameterValue::F32(0.01)), Outcome::Accepted);
    host.run();
    host.steps(5, 1.0);
    // 5 N m need 20 V, and 4.8 V end the run.
    change(&mut host, |motor| motor.supply_v = 5.2);
    let instant = host.bench.now();
    host.steps(60, 1.0);
    let off = host.bench.time_to_off(instant).expect("the bridge off");
    let faults: Vec<_> = host.faults().iter().map(|it| it.code).collect();
    assert_eq!(faults, [FaultCode::TorqueMissing]);
    off
}

/// A winding of which a fifth is left: the loop, made for the whole, holds the current below the fault's limit or switches off.
#[test]
fn a_shorted_winding_is_held_below_the_limit_or_ends_the_run() {
    let motor = motor();
    let mut host = idle(&image(), motor);
    host.run();
    host.steps(5, 1.0);
    change(&mut host, |motor| {
        motor.inductance_h *= 0.2;
        motor.resistance_ohm *= 0.2;
    });
    let torques = torques(&mut host, &motor, Duration::from_millis(5));
    let most_a = torques.iter().fold(0.0_f64, |most, nm| most.max(nm.abs() / motor.torque_constant_nm_a));
    println!("at most {most_a:.0} A");
    // 75 A and what a period adds: 48 V at 0.1 mH.
    assert!(most_a <= 75.0 + 24.0, "{most_a} A");
    // Nothing but the overcurrent may have ended the run.
    let others = host.faults().into_iter().filter(|it| (it.code, it.detail) != (FaultCode::PowerStage, 4));
    assert_eq!(others.collect::<Vec<_>>(), []);
}

#[test]
fn a_run_that_begins_with_too_much_on_its_bus_is_off_after_a_period() {
    let mut host = idle(&image(), motor());
    assert_eq!(host.set("supply_max_v", ParameterValue::F32(40.0)), Outcome::Accepted);
    host.run();
    host.steps(3, 1.0);
    let changes = host.bench.act(|_, site| site.log.bridge.clone());
    let on = changes.windows(2).filter(|pair| pair[0].1.is_on()).map(|pair| pair[1].0 - pair[0].0);
    let on: Duration = on.sum();
    println!("on for {on:?}");
    assert!(on <= Duration::from_micros(56) && !changes.last().expect("a bridge").1.is_on(), "{on:?}");
    assert_eq!(stage_fault(&mut host), 7);
}
