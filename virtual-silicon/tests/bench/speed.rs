//! Processor time for a second of device time, as the program emulates it.

use std::fs;
use std::time::Duration;

use lashloop_plant::electrical::ElectricalParameters;
use lashloop_protocol::enums::{Outcome, ParameterValue};
use lashloop_protocol::message::Stop;
use lashloop_silicon::motor_at_bridge::{BridgeInputs, MotorAtBridge};

use crate::bench::{Bench, image};
use crate::current::{BUS_RANGE_V, motor, settings};
use crate::host::Host;
use crate::report;
use crate::turntable::{self, Speeds};

/// Frequency of the modulation, and of the current loop.
const LOOP_HZ: f64 = 10e3;
/// Device time of a measurement, and how often it is repeated: other programs disturb some of them.
const PIECE: Duration = Duration::from_millis(250);
const PIECES: usize = 16;
/// Most that the fastest piece may take.
const LIMIT: f64 = 0.5;

/// Processor time so far of the thread that runs the chip.
fn processor_time(host: &mut Host) -> Duration {
    let text = host.bench.act(|_, _| fs::read_to_string("/proc/thread-self/schedstat"));
    let text = text.expect("times of a thread");
    Duration::from_nanos(text.split_whitespace().next().and_then(|it| it.parse().ok()).expect("a time"))
}

/// Processor time per device time of the fastest piece, and of the one in the middle.
fn measure(host: &mut Host, piece: impl Fn(&mut Host)) -> [f64; 2] {
    let mut times: Vec<_> = (0..PIECES)
        .map(|_| {
            let (before, from) = (processor_time(host), host.bench.now());
            piece(host);
            (processor_time(host) - before).as_secs_f64() / (host.bench.now() - from).as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    [times[0], times[PIECES / 2]]
}

#[test]
fn a_second_with_a_current_loop_at_10_khz_takes_half_a_second_of_a_core() {
    // A shaft with a count for each radian turns fast: its back-EMF has to be small.
    let motor = ElectricalParameters {
        pwm_hz: LOOP_HZ,
        torque_constant_nm_a: 1e-4,
        resistance_ohm: 1e3,
        inductance_h: 1.0,
        ..motor()
    };
    let at_bridge = MotorAtBridge::new(motor, BridgeInputs::Halves, BUS_RANGE_V.into(), 1);
    let speeds = Speeds::default();
    let train = turntable::drive_train(&speeds, (0, 0)).behind_motor(at_bridge);
    let mut host = Host::of(Bench::plain(&image(), train, speeds));
    host.set_all(&settings(&motor));
    let limits = [("motor_speed_limit_rad_s", 1_500.0), ("load_speed_limit_rad_s", 1_500.0)];
    for (name, value) in limits.into_iter().chain([
        ("twist_limit_rad", 1e5),
        ("torque_limit_nm", 1e-3),
        ("missing_torque_time_s", 1e3),
    ]) {
        assert_eq!(host.set(name, ParameterValue::F32(value)), Outcome::Accepted, "{name}");
    }
    // What runs for the first time is translated.
    let referred = |host: &mut Host| {
        host.steps(PIECE.as_millis() as u32, 0.0);
    };
    host.bench.advance(PIECE);
    let idle = measure(&mut host, |host| host.bench.advance(PIECE));
    host.run();
    referred(&mut host);
    let at_rest = measure(&mut host, referred);
    assert_eq!(host.faults(), [], "at rest");
    // A motor that has rested may not run away from its torque.
    host.command(Stop {});
    host.bench.turn(2e4, 2e4);
    host.bench.advance(Duration::from_millis(2));
    host.run();
    referred(&mut host);
    let turning = measure(&mut host, referred);
    assert_eq!(host.faults(), []);
    let lines: Vec<_> = [("idle", idle), ("running at rest", at_rest), ("running at 20,000 counts/s of both encoders", turning)]
        .iter()
        .map(|(name, [least, middle])| {
            format!("virtual silicon, current loop at 10 kHz, {name}: {least:.2} s of a core per s, {middle:.2} in the middle of {PIECES} pieces")
        })
        .collect();
    report::write("silicon-speed", &lines);
    assert!(at_rest[0] <= LIMIT, "{at_rest:?}");
}
