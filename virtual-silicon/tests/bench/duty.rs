//! Torque against the duty at the pins.

use std::time::Duration;

use lashloop_protocol::enums::{Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{BenchSample, Stop};
use lashloop_silicon::pins::Bridge;

use crate::bench::image;
use crate::host::{BENCH, Host};

const OFF: Bridge = Bridge { duty: None, is_enabled: false, has_main_output: false, has_active_gate: false };
/// Half a count of the modulation, and the nanosecond of the pulse's reading.
const RESOLUTION: f64 = 0.5 / 8_400.0 + 1.0 / 50_000.0;

/// The gains of the law `pd` make a torque for each reference while the encoders stand, two steps after a change.
fn step(host: &mut Host, reference_rad: f32) -> (BenchSample, Bridge) {
    let samples = host.steps(5, reference_rad);
    (*samples.last().expect("samples"), host.bench.bridge())
}

/// The scale of a drive with these parameters.
struct Scale {
    nm_per_full_duty: f64,
    offset: f64,
    min: f64,
    max: f64,
    sign: f64,
}

impl Scale {
    fn duty(&self, torque_nm: f32) -> f64 {
        (self.offset + self.sign * f64::from(torque_nm) / self.nm_per_full_duty).clamp(self.min, self.max)
    }
}

#[test]
fn the_duty_is_the_offset_plus_the_torque_over_its_scale() {
    let scales = [
        Scale { nm_per_full_duty: 100.0, offset: 0.5, min: 0.1, max: 0.9, sign: 1.0 },
        Scale { nm_per_full_duty: 100.0, offset: 0.5, min: 0.1, max: 0.9, sign: -1.0 },
        // Its torque limit of 20 N m just has a duty.
        Scale { nm_per_full_duty: 80.0, offset: 0.55, min: 0.3, max: 0.95, sign: 1.0 },
    ];
    let mut host = Host::idle(&image(), &[]);
    for scale in scales {
        for (name, value) in [
            ("torque_per_duty_nm", ParameterValue::F32(scale.nm_per_full_duty as f32)),
            ("duty_offset", ParameterValue::F32(scale.offset as f32)),
            ("duty_min", ParameterValue::F32(scale.min as f32)),
            ("duty_max", ParameterValue::F32(scale.max as f32)),
            ("torque_direction", ParameterValue::U32(u32::from(scale.sign < 0.0))),
        ] {
            assert_eq!(host.set(name, value), Outcome::Accepted, "{name}");
        }
        host.run();
        let mut torques = Vec::new();
        for reference_rad in [0.0, 0.01, -0.01, 0.3, -0.7, 0.05] {
            let (sample, bridge) = step(&mut host, reference_rad);
            let duty = bridge.driving().expect("the bridge is on");
            let want = scale.duty(sample.torque_nm);
            assert!((duty - want).abs() <= RESOLUTION, "{} N m: {duty}, {want}", sample.torque_nm);
            torques.push(sample.torque_nm);
        }
        assert!(torques.iter().any(|it| *it > 0.0) && torques.iter().any(|it| *it < 0.0), "{torques:?}");
        assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
    }
}

#[test]
fn a_saturated_torque_has_the_duty_of_its_limit() {
    let mut host = Host::running(&image(), &[("torque_limit_nm", ParameterValue::F32(40.0))]);
    for (reference_rad, duty) in [(1_000.0, 0.9), (-1_000.0, 0.1)] {
        let (sample, bridge) = step(&mut host, reference_rad);
        assert_eq!((sample.torque_nm.abs(), sample.status.flags), (40.0, TorqueFlags::SATURATED));
        let have = bridge.driving().expect("the bridge is on");
        assert!((have - duty).abs() <= RESOLUTION, "{have}");
    }
}

#[test]
fn the_duty_follows_a_torque_within_two_cycles_of_the_modulation() {
    let mut host = Host::running(&image(), &[]);
    host.steps(5, 0.0);
    let before = host.bench.now();
    host.steps(2, 0.5);
    let (ticks, bridge) = host.bench.act(|_, site| (site.log.ticks.clone(), site.log.bridge.clone()));
    // The first tick after the reference of 0.14 ms.
    let tick = ticks.iter().find(|at| **at > before + Duration::from_micros(150)).expect("a tick");
    let change = bridge.iter().find(|(at, _)| at > tick).expect("another duty");
    let delay = change.0 - *tick;
    assert!(delay <= Duration::from_micros(100), "{delay:?}");
}

#[test]
fn the_outputs_are_low_unless_running() {
    let mut host = Host::at(&image(), (0, 0));
    assert_eq!(host.bench.bridge(), OFF, "a booted drive");
    for (name, value) in BENCH {
        host.set(name, value);
    }
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
    host.bench.advance(Duration::from_millis(3));
    assert_eq!(host.bench.bridge(), OFF, "an armed drive");
    host.start();
    let on = host.bench.bridge();
    let want = Bridge { duty: Some(0.5), is_enabled: true, has_main_output: true, has_active_gate: true };
    assert_eq!(on, want, "no torque yet");
    host.command(Stop {});
    assert_eq!(host.bench.bridge(), OFF, "a stopped drive");
    let levels = host.bench.act(|chip, _| chip.output_levels());
    assert_eq!(levels, (Some(false), false), "driven low, not open");
}
